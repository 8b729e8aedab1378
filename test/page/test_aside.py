"""A run that lies aside while a recording is shown comes back as it was, under numbers that are new."""

from collections.abc import Iterator

import pytest

from support.page_node import PageNode

ASIDE = """
import { Aside } from "./components/aside.js";
import { Recorder } from "./stream/recorder.js";
import { Run } from "./stream/run.js";
import { Tiles } from "./stream/tiles.js";
globalThis.location = { search: "" };
function answer() {
  const sent = [];
  const source = { send: (command) => sent.push(command), close() {} };
  const tiles = new Tiles();
  const run = new Run(tiles, source.send);
  const recorder = new Recorder();
  const ears = { isOpen: true, isLost: false };
  Object.assign(tiles, { jumps: 5, version: 7, time: 2.5 });
  run.handled.add("cut");
  const aside = new Aside(source, ears, tiles, run, recorder);
  const isDeaf = !ears.isOpen;
  run.handled.clear(); // as the recording does that begins
  Object.assign(tiles, { jumps: 6, version: 9, time: 0 });
  aside.takeUp(tiles, run, recorder);
  return {
    isDeaf, hears: ears.isOpen, handled: [...run.handled], jumps: tiles.jumps, version: tiles.version,
    time: tiles.time, sent: sent.map(({ do: deed }) => deed),
  };
}
"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PageNode]:
    with PageNode(tmp_path_factory.mktemp("page"), ASIDE) as node:
        yield node


def test_it_comes_back_with_what_hands_did_and_with_numbers_that_the_page_has_not_seen(
    page: PageNode,
) -> None:
    back = page.ask(None)
    assert (back["isDeaf"], back["hears"]) == (True, True)
    assert back["handled"] == ["cut"]
    assert (back["jumps"], back["version"], back["time"]) == (7, 10, 2.5)
    assert back["sent"] == ["rest", "rest", "seek"]
