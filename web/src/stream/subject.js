// What a line of a tile is about: the twin of subject_of of host/tilenca/page/outbox.py and of page/stream/sentences.js.

const NAMES = ["HELLO", "TILE", "LINK", "TIME", "CHIP", "BOARD", "ERROR", "ACK", "NAK"];
const FRAMED = /^\$([ -)+-~]*)\*([0-9A-F]{2})$/;

/**
 * The name of a sentence, and the side of a `LINK`; "" for all lines that are none: damage takes no place of what
 * a tile has said, and many damaged lines are no more than one.
 * @param {string} raw
 */
export function subjectOf(raw) {
  const found = FRAMED.exec(raw);
  if (!found) return "";
  let sum = 0;
  for (let at = 0; at < found[1].length; at++) sum ^= found[1].charCodeAt(at);
  const [name, , , side] = found[1].split(",");
  if (sum !== parseInt(found[2], 16) || !NAMES.includes(name)) return "";
  return name === "LINK" ? `LINK ${side}` : name;
}
