// Makes the report page of its parts and writes it as C++: what stands before the data and after it.
// Usage: node bundle.mjs FOLDER_WITH_NODE_MODULES OUTPUT.cc

import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const [packages, output] = process.argv.slice(2).map((path) => resolve(path));
const esbuild = createRequire(join(packages, "/"))("esbuild");

/** As the content security policy names an inline script or style. */
function fingerprint(text) {
  return `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
}

function bundle(entry) {
  const result = esbuild.buildSync({
    entryPoints: [join(here, entry)],
    nodePaths: [join(packages, "node_modules")],
    bundle: true,
    minify: true,
    write: false,
    charset: "ascii",
    format: "iife",
    target: ["chrome100", "firefox100", "safari15"],
    legalComments: "inline",
    logLevel: "warning",
  });
  return result.outputFiles[0].text;
}

function page() {
  const script = bundle("src/main.js");
  const style = bundle("style.css");
  if (/<\/script|<!--/i.test(script) || /<\/style/i.test(style)) {
    throw new Error("the bundle would end its own element");
  }
  const parts = {
    STYLE: style,
    SCRIPT: script,
    STYLE_HASH: fingerprint(style),
    SCRIPT_HASH: fingerprint(script),
  };
  // A function as the replacement: '$' in a bundle means nothing then.
  return readFileSync(join(here, "index.html"), "utf8")
    .replace(/\{\{([A-Z_]+)\}\}/g, (whole, name) => (name === "DATA" ? whole : parts[name]))
    .split("{{DATA}}");
}

/** C++ literals of at most 8192 characters: compilers limit how long one may be. */
function literals(text) {
  const escaped = (piece) =>
    piece.replace(/[^\x20-\x7e]|["\\?]/gu, (character) =>
      [...Buffer.from(character)].map((byte) => `\\${byte.toString(8).padStart(3, "0")}`).join(""));
  const pieces = text.match(/[^]{1,8192}/gu) ?? [];
  return pieces.map((piece) => `    "${escaped(piece)}",`).join("\n");
}

const [before, after] = page();
writeFileSync(output, `// Made by bundle.mjs.
#include "mapbuilder/report/page_template.h"

namespace waymark {
namespace {

const std::string_view kBefore[] = {
${literals(before)}
};
const std::string_view kAfter[] = {
${literals(after)}
};

}  // namespace

std::span<const std::string_view> page_before_data() { return kBefore; }
std::span<const std::string_view> page_after_data() { return kAfter; }

}  // namespace waymark
`);
