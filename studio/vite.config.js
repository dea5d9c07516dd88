// Builds the page into the Python package: three files with fixed names, the font inside the style.
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { defineConfig } from "vite";

const OUT = "../src/microswim/studio/static";
const BUILT = ["index.html", "studio.css", "studio.js"];

const text = (file) => readFileSync(file, "utf8").replaceAll("\r\n", "\n");
const sha256 = (...parts) => parts.reduce((hash, part) => hash.update(part), createHash("sha256")).digest("hex");

/** All that the page is made of, folders below src too. */
function sources() {
  const inside = readdirSync("src", { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => `${entry.parentPath ?? entry.path}/${entry.name}`.replaceAll("\\", "/"));
  return [...inside, "index.html", "package.json", "package-lock.json", "tsconfig.json", "vite.config.js"].sort();
}

// Of which sources the page was built, and what it came to: tests/studio/test_studio.py compares.
const stamp = {
  name: "stamp",
  closeBundle() {
    const lines = [[sha256(...sources().flatMap((file) => [`${file}\n`, text(file)])), "sources"]];
    for (const file of BUILT) lines.push([sha256(text(`${OUT}/${file}`)), file]);
    writeFileSync(`${OUT}/sources.txt`, lines.map(([hash, name]) => `${hash}  ${name}\n`).join(""));
  },
};

export default defineConfig({
  base: "/static/",
  plugins: [stamp],
  build: {
    outDir: OUT,
    emptyOutDir: false,
    assetsInlineLimit: 400_000,
    chunkSizeWarningLimit: 1000,
    cssCodeSplit: false,
    rollupOptions: {
      output: {
        entryFileNames: "studio.js",
        assetFileNames: "studio[extname]",
        codeSplitting: false,
      },
    },
    modulePreload: false,
  },
  server: { proxy: { "/api": "http://127.0.0.1:8642" } },
});
