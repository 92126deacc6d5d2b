// SPDX-License-Identifier: Apache-2.0
// Scripts of sessions through the codec in WebAssembly (session_module.cpp). For Node and browsers.

/** in  bytes  of the module.   out  a function that answers a script, as the testee does, and null to what is none */
export async function loadSessions(bytes) {
  const module = await WebAssembly.compile(bytes);
  // Its standard streams name functions of a system, and nothing calls them.
  const calls = WebAssembly.Module.imports(module).map(({name}) => [name, () => { throw new Error(`${name} is called`); }]);
  const {exports} = await WebAssembly.instantiate(module, {wasi_snapshot_preview1: Object.fromEntries(calls)});
  exports._initialize();
  return (script) => {
    const text = new TextEncoder().encode(`${script}\0`);
    const at = exports.malloc(text.length);
    new Uint8Array(exports.memory.buffer, at, text.length).set(text);
    const answers = exports.answer_session(at);
    exports.free(at);
    if (answers === 0) return null;
    const all = new Uint8Array(exports.memory.buffer, answers);
    return new TextDecoder().decode(all.subarray(0, all.indexOf(0)));
  };
}

/** The first line that is not as expected, or null. */
export function checkSession(answer, {script, expected}) {
  const lines = answer(script)?.split("\n");
  if (!lines) return "the script cannot be read";
  const wanted = expected.split("\n");
  const wrong = wanted.findIndex((line, i) => line !== lines[i]);
  if (wrong >= 0) return `line ${wrong} is ${lines[wrong]}`;
  return lines.length === wanted.length ? null : `${lines.length} lines, not ${wanted.length}`;
}
