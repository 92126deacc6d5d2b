// SPDX-License-Identifier: Apache-2.0
// What is beyond a decoder through the codec in WebAssembly (session_module.cpp): sessions, clients with a device. For Node and browsers.

/** in  bytes  of the module.   out  a function that answers input as the testee does, and null to a script that cannot be read */
export async function loadSessions(bytes) {
  const module = await WebAssembly.compile(bytes);
  // Its standard streams name functions of a system, and nothing calls them.
  const calls = WebAssembly.Module.imports(module).map(({name}) => [name, () => { throw new Error(`${name} is called`); }]);
  const {exports} = await WebAssembly.instantiate(module, {wasi_snapshot_preview1: Object.fromEntries(calls)});
  exports._initialize();
  return (input, isSession) => {
    const at = exports.malloc(input.length + 1);
    const room = new Uint8Array(exports.memory.buffer, at, input.length + 1);
    room.set(input);
    room[input.length] = 0;
    const answers = isSession ? exports.answer_session(at) : exports.answer_with_device(at, input.length);
    exports.free(at);
    if (answers === 0) return null;
    const all = new Uint8Array(exports.memory.buffer, answers);
    return new TextDecoder().decode(all.subarray(0, all.indexOf(0)));
  };
}

/** The first line that is not as expected, or null.   in  input  bytes in base64 */
export function checkSession(answer, {input, isSession, expected}) {
  const lines = answer(Uint8Array.from(atob(input), (c) => c.charCodeAt(0)), isSession)?.split("\n");
  if (!lines) return "the script cannot be read";
  const wanted = expected.split("\n");
  const wrong = wanted.findIndex((line, i) => line !== lines[i]);
  if (wrong >= 0) return `line ${wrong} is ${lines[wrong]}`;
  return lines.length === wanted.length ? null : `${lines.length} lines, not ${wanted.length}`;
}
