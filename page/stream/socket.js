// The source that is a server: a WebSocket, opened again whenever it is lost.

/** @import { Command, Listener, Source, StreamEvent } from "./source.js" */

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;

/**
 * @param {string} url of the stream, ws: or wss:
 * @param {Listener} listener told of events once for every frame that the browser paints
 * @returns {Source}
 */
export function openSocket(url, listener) {
  /** @type {WebSocket | null} */
  let socket = null;
  let waitMs = FIRST_WAIT_MS;
  let closed = false;
  /** @type {StreamEvent[]} */
  let events = [];
  let batch = 0;
  let isDue = false;

  function paint() {
    isDue = false;
    const shown = events;
    events = [];
    listener.onEvents(shown);
    send({ do: "seen", batch });
  }

  /** @param {Command} command */
  function send(command) {
    if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(command));
  }

  function connect() {
    socket = new WebSocket(url);
    socket.onopen = () => {
      waitMs = FIRST_WAIT_MS;
      batch = 0;
      listener.onOpen();
    };
    socket.onmessage = (message) => {
      const told = JSON.parse(message.data);
      events.push(...told.events);
      batch = told.batch;
      if (!isDue) {
        isDue = true;
        requestAnimationFrame(paint);
      }
    };
    socket.onclose = () => {
      socket = null;
      if (closed) return;
      listener.onLost(waitMs / 1000);
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
