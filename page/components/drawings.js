// The drawings to choose from; one slides under the running tiles.

/** @import { Drawing, Model } from "../stream/source.js" */
/** @import { Tiles } from "../stream/tiles.js" */
import { cellsOf } from "../stream/drawing.js";
import { seenColour } from "../stream/led.js";
import { PENCIL } from "./bar.js";
import { element, icon, svg } from "./dom.js";

// The brighter one of --housing in styles/base.css.
const HOUSING = [29, 30, 35];

// More drawings of a file are told apart by their labels, in a list that scrolls.
const MOST_IN_VIEW = 40;

/** @param {Drawing} drawing @param {string} colour */
function thumbnail(drawing, colour) {
  const cols = drawing.rows[0].length;
  const rows = drawing.rows.length;
  const side = Math.max(cols, rows, 5);
  const cells = cellsOf(drawing.rows).map(([row, col]) => svg("rect", {
    x: col + (side - cols) / 2 + 0.06, y: row + (side - rows) / 2 + 0.06, width: 0.88, height: 0.88, rx: 0.18,
  }));
  const picture = svg("svg", { viewBox: `0 0 ${side} ${side}`, "aria-hidden": "true" }, ...cells);
  /** @type {SVGElement} */ (picture).style.setProperty("--led", colour);
  return picture;
}

export class Drawings {
  /**
   * @param {HTMLElement} root
   * @param {{slide: (drawing: Drawing) => void, clear: () => void, model: (model: Model) => void}} deeds
   */
  constructor(root, deeds) {
    this.root = root;
    this.deeds = deeds;
    /** @type {Map<string, HTMLButtonElement>} */
    this.buttons = new Map();
  }

  /** @param {Tiles} tiles */
  fill(tiles) {
    const { drawings } = tiles;
    this.buttons.clear();
    const heading = element("h2", { id: "drawings-title" }, "Drawings");
    const help = element("p", { class: "summary" }, "Choose one: it slides under the running tiles.");
    const own = element("button", { type: "button", "data-needs": "put", title: "Empties the board, and takes the pencil", onclick: () => this.deeds.clear() },
      icon(PENCIL), "Draw your own");
    /** @type {Map<string, Drawing[]>} */
    const files = new Map();
    for (const one of drawings) {
      const file = one.name.split("/")[0];
      files.set(file, [...(files.get(file) ?? []), one]);
    }
    const parts = [...files].map(([file, members]) => {
      const labels = [...new Set(members.map(({ label }) => label))];
      const isLong = members.length > MOST_IN_VIEW && labels.length < members.length;
      /** @type {Map<string, HTMLElement>} */
      const lists = new Map(labels.map((label) => [label, element("div", { class: "gallery", role: "group", "aria-label": `${file}, ${label}` })]));
      const whole = element("div", { class: "gallery", role: "group", "aria-label": file });
      for (const one of members) {
        const button = element("button", {
          type: "button", "aria-pressed": "false", "aria-label": `${one.label}, ${one.name}`, title: one.name,
          onclick: () => this.deeds.slide(one),
        });
        button.append(thumbnail(one, seenColour(tiles.look(one.label).rgb, HOUSING)));
        this.buttons.set(one.name, button);
        (isLong ? lists.get(one.label) : whole)?.append(button);
      }
      const list = isLong ? element("div", { class: "long" }, ...[...lists].flatMap(([label, part]) => [element("h4", {}, label), part])) : whole;
      return element("div", { class: "file" }, element("h3", {}, file.replaceAll("-", " ")), list);
    });
    this.root.replaceChildren(...this.models(tiles), ...(drawings.length ? [heading, help, own, ...parts] : []));
  }

  /** The choice of a model, where there is one. @param {Tiles} tiles */
  models({ models, model }) {
    if (models.length < 2) return [];
    const options = models.map(({ name, labels }) =>
      element("option", { value: name, selected: name === model }, `${name}: ${labels.join(" ")}`));
    const select = element("select", {
      id: "model",
      onchange: () => {
        const chosen = models.find(({ name }) => name === select.value);
        if (chosen) this.deeds.model(chosen);
      },
    }, ...options);
    return [element("label", { class: "model", for: "model" }, element("span", {}, "Model"), select)];
  }

  /** Scrolls a long list to a drawing, and nothing else. @param {HTMLElement} button */
  reveal(button) {
    const list = button.closest(".long");
    if (!list) return;
    const [{ top, bottom, height }, box] = [button, list].map((one) => one.getBoundingClientRect());
    if (top < box.top || bottom > box.bottom) list.scrollTop += top - box.top - (box.height - height) / 2;
  }

  /** @param {string} name of the drawing that lies on the board; "" for none of them */
  mark(name) {
    for (const [one, button] of this.buttons) {
      const pressed = String(one === name);
      if (button.getAttribute("aria-pressed") === pressed) continue;
      button.setAttribute("aria-pressed", pressed);
      if (one === name) this.reveal(button);
    }
  }
}
