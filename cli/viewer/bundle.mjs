// SPDX-License-Identifier: Apache-2.0
// bundle.mjs SOURCE DECODER MODULES OUTPUT: one HTML file of the page's sources, three.js and the decoder. The page's policy names the
// hashes of its only program and style, so that nothing else in it can run.
import {createHash} from "node:crypto";
import {readFileSync, writeFileSync} from "node:fs";
import {createRequire} from "node:module";
import {join} from "node:path";

const [source, decoder, modules, output] = process.argv.slice(2);
const esbuild = createRequire(join(modules, "package.json"))("esbuild");

const bundled = await esbuild.build({
  entryPoints: [join(source, "main.js")],
  bundle: true, minify: true, write: false, format: "esm", target: "es2022", charset: "ascii", legalComments: "inline",
  nodePaths: [join(modules, "node_modules")],
  alias: {"@tactus-codec/decoder": join(decoder, "index.js")},
  external: ["node:*"],
});
const style = (await esbuild.transform(readFileSync(join(source, "style.css"), "utf8"), {loader: "css", minify: true})).code.trim();
const script = bundled.outputFiles[0].text.replaceAll("</script", "<\\/script").trim();
const hash = (text) => createHash("sha256").update(text).digest("base64");

const parts = {
  STYLE: style, SCRIPT: script, STYLE_HASH: hash(style), SCRIPT_HASH: hash(script),
  WASM: readFileSync(join(decoder, "tactus.wasm")).toString("base64"),
};
const page = readFileSync(join(source, "page.html"), "utf8").replace(/@(\w+)@/g, (_, name) => parts[name]);
writeFileSync(output, page);
