// The source that is a server: a WebSocket, opened again whenever it is lost.

/** @import { Command, Listener, Source, StreamEvent } from "./source.js" */
import { Batches } from "./batches.js";
import { BROKE_OFF, WRONG_TOKEN } from "./source.js";

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;
// After these another try would end the same way.
const FINAL = [WRONG_TOKEN, BROKE_OFF];

/**
 * The stream of the server that the page has come from, with the token and the model of its address.
 * @param {Listener} listener
 */
export function openServer(listener) {
  return openSocket(() => {
    const token = new URLSearchParams(location.hash.slice(1)).get("token");
    const model = new URLSearchParams(location.search).get("model");
    const url = new URL("stream", location.href);
    url.protocol = url.protocol.replace("http", "ws");
    url.search = new URLSearchParams({ ...(token && { token }), ...(model && { model }) }).toString();
    url.hash = "";
    return url.href;
  }, listener);
}

/**
 * @param {() => string} urlNow of the stream, ws: or wss:
 * @param {Listener} listener told of events once for every frame that the browser paints
 * @returns {Source}
 */
export function openSocket(urlNow, listener) {
  /** @type {WebSocket | null} */
  let socket = null;
  let waitMs = FIRST_WAIT_MS;
  let closed = false;
  const batches = new Batches(listener.onEvents, send);

  /** @param {Command} command */
  function send(command) {
    if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(command));
  }

  function connect() {
    socket = new WebSocket(urlNow());
    socket.onmessage = (message) => {
      const told = JSON.parse(message.data);
      if (told.events.some((/** @type {StreamEvent} */ event) => event.stream !== undefined)) {
        waitMs = FIRST_WAIT_MS; // not as soon as it is open: a server that is full opens it to say so
        listener.onOpen();
      }
      batches.take(told);
    };
    socket.onclose = ({ code }) => {
      socket = null;
      if (closed) return;
      batches.paint(); // what it said last comes before the news that it has gone
      listener.onLost(waitMs / 1000, code);
      if (FINAL.includes(code)) return;
      setTimeout(connect, waitMs);
      waitMs = Math.min(waitMs * 2, LONGEST_WAIT_MS);
    };
  }

  connect();
  return {
    send,
    close() {
      closed = true;
      socket?.close();
    },
  };
}
