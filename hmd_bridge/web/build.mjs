// Builds the page into a folder:  node build.mjs --out FOLDER [--python PROGRAM] [--tests FOLDER]
// With --tests the tests of tests/web are built too, for `node --test FOLDER/unit/` and the browser tests.
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, readdirSync, rmSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const { values } = parseArgs({
  options: { out: { type: "string" }, python: { type: "string", default: "python3" }, tests: { type: "string" } },
});
if (!values.out) {
  console.error("usage: node build.mjs --out FOLDER [--python PROGRAM] [--tests FOLDER]");
  process.exit(2);
}
const out = resolve(values.out);
const tests = values.tests && resolve(values.tests);

execFileSync(values.python, [join(here, "../protocol/generate.py"), "--ts", join(here, "generated/messages.ts")], { stdio: "inherit" });

rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });
await build({
  entryPoints: { app: join(here, "src/main.ts"), mesh_worker: join(here, "src/map/mesh_worker.ts") },
  outdir: out,
  bundle: true,
  format: "esm",
  target: "es2022",
  minify: true,
  sourcemap: true,
  logLevel: "warning",
});
cpSync(join(here, "public"), out, { recursive: true });

if (tests) {
  const source = join(here, "../../tests/web");
  const entries = ["unit", "browser"].flatMap((folder) =>
    readdirSync(join(source, folder)).filter((name) => name.endsWith(".test.ts")).map((name) => join(source, folder, name)));
  rmSync(tests, { recursive: true, force: true });
  await build({
    entryPoints: entries,
    outdir: tests,
    outbase: source,
    bundle: true,
    format: "cjs",
    outExtension: { ".js": ".cjs" },
    platform: "node",
    target: "node18",
    external: ["playwright-core", "ws"],
    nodePaths: [join(here, "node_modules")],
    sourcemap: "inline",
    logLevel: "warning",
  });
  await build({
    entryPoints: { emulator: join(source, "support/emulator.ts") },
    outdir: tests,
    bundle: true,
    format: "iife",
    target: "es2022",
    nodePaths: [join(here, "node_modules")],
    logLevel: "warning",
  });
}
