// SPDX-License-Identifier: Apache-2.0
// The vectors of streams; those of sessions need a client, which the decoder is not.
import {readFileSync} from "node:fs";
import {join} from "node:path";

export function readVectors(folder) {
  const {stems} = JSON.parse(readFileSync(join(folder, "manifest.json")));
  const vectors = [];
  for (const stem of Object.keys(stems).filter((name) => name !== "session")) {
    const {cases} = JSON.parse(readFileSync(join(folder, "vectors", `${stem}.json`)));
    for (const {name, args, repeat} of cases) {
      const file = join(folder, "vectors", stem, name);
      const expected = readFileSync(`${file}.jsonl`, "utf8").split("\n").filter(Boolean).map((line) => JSON.parse(line));
      vectors.push({id: `${stem}/${name}`, bytes: new Uint8Array(readFileSync(`${file}.tct`)), expected, args, repeat});
    }
  }
  return vectors;
}
