// SPDX-License-Identifier: Apache-2.0
// The vectors of streams, for the decoder, and those of sessions and of clients with a device, for sessions.js.
import {readFileSync} from "node:fs";
import {join} from "node:path";

function casesOf(folder, isWanted) {
  const {stems} = JSON.parse(readFileSync(join(folder, "manifest.json")));
  return Object.keys(stems).filter(isWanted).flatMap((stem) => {
    const {cases} = JSON.parse(readFileSync(join(folder, "vectors", `${stem}.json`)));
    return cases.map((one) => ({...one, stem, id: `${stem}/${one.name}`, file: join(folder, "vectors", stem, one.name)}));
  });
}

const isSession = (stem) => stem === "session";

export function readVectors(folder) {
  return casesOf(folder, (stem) => !isSession(stem)).map(({id, file, args, repeat}) => {
    const expected = readFileSync(`${file}.jsonl`, "utf8").split("\n").filter(Boolean).map((line) => JSON.parse(line));
    return {id, bytes: new Uint8Array(readFileSync(`${file}.tct`)), expected, args, repeat};
  });
}

export function readSessions(folder) {
  const hasDevice = ({args}) => args?.[1] === "device";
  return casesOf(folder, () => true).filter((one) => isSession(one.stem) || hasDevice(one)).map(({id, stem, file}) => {
    const input = readFileSync(`${file}.${isSession(stem) ? "script" : "tct"}`, "base64");
    return {id, isSession: isSession(stem), input, expected: readFileSync(`${file}.jsonl`, "utf8")};
  });
}
