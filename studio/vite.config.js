// Builds the page into the Python package: three files with fixed names, the font inside the style.
import { defineConfig } from "vite";

export default defineConfig({
  base: "/static/",
  build: {
    outDir: "../src/microswim/studio/static",
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
