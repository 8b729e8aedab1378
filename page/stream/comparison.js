// Two runs in words: in what they differ, and what came of it.

/** @import { Now } from "../components/framed.js" */
import { named } from "./source.js";

/** What a run begins with: each with a name, what it is, and how that is said. @typedef {[name: string, value: string, words: string][]} Settings */

/** @param {Settings} left @param {Settings} right the same names in the same order */
export function differenceWords(left, right) {
  const parts = left.flatMap(([name, value, words], index) => {
    const [, other, otherWords] = right[index];
    return value === other ? [] : [`${name} (${words}, ${otherWords})`];
  });
  if (!parts.length) return "Both runs are alike. Change a setting of one of them, or pull out a tile.";
  return `Left and right differ in ${new Intl.ListFormat("en").format(parts)}.`;
}

/** @param {Now} now */
const agreementWords = ({ since, label }) => (since === null ? "has not agreed yet" : `agreed on ${named(label)} at ${since.toFixed(2)} s`);

/** @param {Now} left @param {Now} right */
export function resultWords(left, right) {
  const later = left.since !== null && right.since !== null ? right.since - left.since : 0;
  const isLater = Math.abs(later) >= 0.005;
  const apart = isLater ? `, ${Math.abs(later).toFixed(2)} s ${later > 0 ? "later" : "sooner"}` : "";
  return `Left ${agreementWords(left)}, right ${agreementWords(right)}${apart}. Changes of mind: ${left.changes} and ${right.changes}.`;
}
