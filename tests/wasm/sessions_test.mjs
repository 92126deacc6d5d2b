// SPDX-License-Identifier: Apache-2.0
// sessions_test.mjs CONFORMANCE MODULE: both ends of sessions in WebAssembly over the conformance vectors of sessions.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {readSessions} from "./read_vectors.mjs";
import {checkSession, loadSessions} from "./sessions.js";

const [conformance, module] = process.argv.slice(2);
const answer = await loadSessions(readFileSync(module));
const sessions = readSessions(conformance);
assert.ok(sessions.length > 60);
assert.deepEqual(sessions.map((one) => [one.id, checkSession(answer, one)]).filter(([, problem]) => problem !== null), []);
console.log(`${sessions.length} scripts of sessions, all answers as expected`);

// The check can fail.
const [{script, expected}] = sessions;
assert.match(checkSession(answer, {script, expected: expected.replace("joining", "live")}), /line 0 is/);
assert.match(checkSession(answer, {script, expected: `${expected}{}\n`}), /line \d+ is|lines, not/);
assert.equal(checkSession(answer, {script: '{"at":0,"heard":"xy"}', expected}), "the script cannot be read");
