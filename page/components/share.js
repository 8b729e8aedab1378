// What one can take along: the link, a picture of the board, a recording; and a recording to look at.

/** @import { Tiles } from "../stream/tiles.js" */
/** @import { Recorder } from "../stream/recorder.js" */
/** @import { StreamEvent } from "../stream/source.js" */
import { parseRecording } from "../stream/recording_file.js";
import { TOO_MUCH } from "../stream/run.js";
import { byId, element, icon, setText } from "./dom.js";
import { boardFilm } from "./film.js";
import { boardPicture } from "./picture.js";

const ICON = "M12 15V4M8 8l4-4 4 4M5 12v7h14v-7";
const FILM_S = 5; // of the wall clock
const JSON_LINES = "application/jsonl";
const LOOPBACK = /^(localhost|.*\.localhost|127(\.\d+){3}|\[::1\])$/;
// Twin of HOLE in host/tilenca/page/alone.py.
const HOLE = "<!-- the recording -->";

/**
 * @typedef {{
 *   links: () => {now: string, history: string | null},
 *   words: () => string,
 *   lens: () => import("../stream/lens.js").Lens | null,
 *   inChart: () => {from: number, to: number},
 *   say: (text: string, stays?: boolean) => void,
 *   replay: (events: StreamEvent[], isCut: boolean) => void,
 *   compare: () => void,
 *   canAlone: () => boolean,
 * }} ShareDeeds
 */

/** Hands bytes over as a file. @param {Blob} blob @param {string} name */
function download(blob, name) {
  const address = URL.createObjectURL(blob);
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

export class Share {
  /** @param {HTMLElement} top @param {Tiles} tiles @param {Recorder} recorder @param {ShareDeeds} deeds */
  constructor(top, tiles, recorder, deeds) {
    this.tiles = tiles;
    this.recorder = recorder;
    this.deeds = deeds;
    this.dialog = /** @type {HTMLDialogElement} */ (byId("share"));
    this.link = element("input", { type: "text", readonly: true, id: "share-link", "aria-label": "Link" });
    this.links = { now: "", history: /** @type {string | null} */ (null) };
    this.until = element("span", { class: "summary" });
    /** @param {string} id @param {string} name @param {string | HTMLElement} help */
    const choice = (id, name, help) => {
      const input = element("input", { type: "radio", name: "share-what", id, onchange: () => this.showLink() });
      return { input, label: element("label", { class: "choice", for: id }, input, element("span", {}, `${name}: `, help)) };
    };
    this.now = choice("share-now", "The board as it is now", element("span", { class: "summary" }, "begins when these tiles are switched on"));
    this.history = choice("share-history", "How it came about", this.until);
    this.here = element("p", { class: "summary" }, "Opens on this computer only; to send it, use Web page or a public copy of the page");
    this.here.hidden = !LOOPBACK.test(location.hostname);
    this.file = element("input", {
      type: "file", accept: ".jsonl", id: "share-file", class: "visually-hidden", tabindex: -1, "aria-hidden": "true",
      onchange: () => this.open(),
    });
    /** @param {string} text @param {string} help @param {() => void} act */
    const row = (text, help, act) => element("div", { class: "row" },
      element("button", { type: "button", onclick: act }, text), element("p", { class: "summary" }, help));
    this.part = element("select", { "aria-label": "What the GIF shows", id: "share-part" },
      ...[["now", "The last seconds, as the page has shown them"], ["change", "The last changes of mind"], ["chart", "What the chart shows, until now"]]
        .map(([value, text]) => element("option", { value }, text)));
    this.film = element("div", { class: "row" }, element("button", { type: "button", onclick: () => this.gif() }, "GIF"), this.part);
    this.alone = row("Web page", "This run until now, as one file that replays in any browser", () => this.page());
    this.compare = row("Compare", "Two runs side by side, both from 0 s: another model, drawing, seed, or more lost bytes", () => deeds.compare());
    this.compare.dataset.needs = "arrange";
    this.dialog.append(
      element("header", {}, element("h2", { id: "share-title" }, "Share"),
        element("button", { type: "button", class: "plain", "aria-label": "Close", onclick: () => this.dialog.close() }, "×")),
      element("div", { class: "links-to-share", "data-needs": "arrange" },
        element("fieldset", {}, element("legend", { class: "visually-hidden" }, "What the link opens"), this.now.label, this.history.label),
        element("div", { class: "row" }, this.link, element("button", { type: "button", onclick: () => this.copy() }, "Copy")), this.here),
      row("Picture", "The board as it is now, as PNG", () => this.picture()),
      this.film,
      row("Record", "This run until now, as a file that the page replays", () => this.record()),
      this.alone,
      this.compare,
      row("Replay a file…", "Shows a recording instead of running tiles; or drop it on the page", () => this.file.click()),
      this.file,
    );
    // Else the browser would leave the page for the file.
    document.addEventListener("dragover", (event) => event.preventDefault());
    document.addEventListener("drop", (event) => {
      event.preventDefault();
      const [file] = event.dataTransfer?.files ?? [];
      if (file) this.replay(file);
    });
    top.prepend(element(
      "button", { type: "button", class: "compact", title: "Link, picture, recording; compare, replay", onclick: () => this.show() },
      icon(ICON), element("span", {}, "Share"),
    ));
  }

  show() {
    this.alone.hidden = !this.deeds.canAlone();
    this.links = this.deeds.links();
    this.now.input.checked = true;
    this.history.input.disabled = this.links.history === null;
    setText(this.until, this.links.history === null ? TOO_MUCH : `all that was done, again, until ${this.tiles.time.toFixed(2)} s`);
    this.dialog.showModal();
    this.showLink();
  }

  showLink() {
    this.link.value = (this.history.input.checked && this.links.history) || this.links.now;
    this.link.select();
  }

  async copy() {
    this.link.select();
    try {
      await navigator.clipboard.writeText(this.link.value);
    } catch {
      document.execCommand("copy"); // pages that came over plain http have no clipboard
    }
    this.deeds.say("The link is copied.");
  }

  /** @param {string} kind the end of its name */
  nameOf(kind) {
    return `tilenca-${this.tiles.seed}-${this.tiles.time.toFixed(2)}s.${kind}`;
  }

  /** Does something that may fail, and says why. @param {() => Promise<void>} act */
  async attempt(act) {
    try {
      await act();
    } catch (error) {
      this.deeds.say(`It did not work: ${error instanceof Error ? error.message : error}`);
    }
  }

  picture() {
    const [painting, name] = [{ words: this.deeds.words(), lens: this.deeds.lens() }, this.nameOf("png")]; // of one moment
    return this.attempt(async () => download(await boardPicture(this.tiles, painting), name));
  }

  /** What of the run the GIF shows, and how long it lasts; null: there is no such part. */
  span() {
    const { time: now, pace, history } = this.tiles;
    if (this.part.value === "now") {
      const from = Math.max(0, now - FILM_S * (pace.speed || 1));
      return { from, to: now, seconds: (now - from) / (pace.speed || 1) };
    }
    const part = this.part.value === "chart" ? this.deeds.inChart() : history.lastBurst(now);
    return part && { ...part, seconds: FILM_S };
  }

  gif() {
    if (this.recorder.isFull) return this.deeds.say("The recording is too long; it has the beginning only, and no GIF can be made of it. Restart the run for one.");
    const part = this.span();
    if (!part) return this.deeds.say("No tile has changed its mind yet; choose another part for the GIF.");
    const { from, to } = part;
    const button = /** @type {HTMLButtonElement} */ (this.film.firstElementChild);
    button.disabled = true;
    const span = `${from.toFixed(2)} to ${to.toFixed(2)} s`;
    this.deeds.say(`The GIF of ${span} is being made.`, true);
    return this.attempt(async () => {
      const film = await boardFilm(this.recorder.recording(), part, this.deeds.lens(),
        (left) => this.deeds.say(`The GIF of ${span} is being made: about ${Math.ceil(left)} s more.`, true));
      const name = `tilenca-${this.tiles.seed}-${to.toFixed(2)}s.gif`;
      download(film, name);
      this.deeds.say(`The GIF of ${span} is saved as ${name}; it has ${Math.ceil(film.size / 1000)} kB.`);
    }).finally(() => {
      button.disabled = false;
      button.focus();
    });
  }

  /** The page with the recording in it. */
  page() {
    return this.attempt(async () => {
      const answer = await fetch("alone.html");
      if (!answer.ok) throw new Error(`alone.html: ${answer.status}`);
      const lines = this.recorder.text().replaceAll("<", "\\u003c");
      const script = `<script type="application/jsonl" id="recording">\n${lines}</script>`;
      const document = (await answer.text()).replace(HOLE, () => script);
      this.save(new Blob([document], { type: "text/html" }), "html");
    });
  }

  record() {
    this.save(new Blob([this.recorder.text()], { type: JSON_LINES }), "jsonl");
  }

  /** Hands a recording over. @param {Blob} blob @param {string} kind the end of its name */
  save(blob, kind) {
    const name = this.nameOf(kind);
    download(blob, name);
    this.deeds.say(`It is saved as ${name}${this.recorder.isFull ? "; the recording is too long, and has the beginning only" : ""}.`);
  }

  async open() {
    const [file] = this.file.files ?? [];
    if (!file) return;
    await this.replay(file);
    this.file.value = "";
  }

  /** @param {File} file */
  async replay(file) {
    this.dialog.close();
    try {
      const { events, isCut } = parseRecording(await file.text());
      this.deeds.replay(events, isCut);
    } catch (error) {
      this.deeds.say(`${file.name}: ${error instanceof Error ? error.message : error}`);
    }
  }
}
