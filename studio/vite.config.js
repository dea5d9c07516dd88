// Builds the page into the Python package: three files with fixed names, the font inside the style.
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { defineConfig } from "vite";

const OUT = "../src/microswim/studio/static";

// Of which sources the page was built: tests/test_studio.py compares.
const stamp = {
  name: "stamp",
  closeBundle() {
    const sources = [...readdirSync("src").sort().map((f) => `src/${f}`), "index.html", "package-lock.json", "vite.config.js"];
    const hash = createHash("sha256");
    for (const f of sources) hash.update(`${f}\n`).update(readFileSync(f, "utf8").replaceAll("\r\n", "\n"));
    writeFileSync(`${OUT}/sources.txt`, `${hash.digest("hex")}\n`);
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
