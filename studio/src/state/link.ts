// A link that holds the designs on show: their tables, packed into what stands behind the # of the address.

import { call } from "./api";
import type { Store } from "./store";
import type { Answer, Tables } from "./types";

const MARK = "#d=";
/** characters; longer addresses are cut by mail and chat */
const LONGEST = 6000;

interface Held {
  designs: { name: string; tables: Tables }[];
  active: number;
}

/** The address with the designs in it; null where they are too long for one. */
export async function link(store: Store): Promise<string | null> {
  const held: Held = { designs: store.designs.map((d) => ({ name: d.name, tables: d.answer.tables })), active: store.active };
  const packed = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(JSON.stringify(held)));
  const text = btoa(String.fromCharCode(...packed)).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
  const { origin, pathname } = window.location;
  return text.length > LONGEST ? null : `${origin}${pathname}${MARK}${text}`;
}

/** Keep the address that of what is shown, so that it can be copied or kept as a bookmark. */
export async function show(store: Store): Promise<void> {
  const address = await link(store);
  window.history.replaceState(null, "", address ?? window.location.pathname);
}

/** Put the designs of the address on show, if it holds any. */
export async function follow(store: Store): Promise<boolean> {
  const { hash } = window.location;
  if (!hash.startsWith(MARK)) return false;
  let held: Held;
  try {
    const text = atob(hash.slice(MARK.length).replace(/-/g, "+").replace(/_/g, "/"));
    const unpacked = await through(new DecompressionStream("deflate-raw"), Uint8Array.from(text, (c) => c.charCodeAt(0)));
    held = JSON.parse(new TextDecoder().decode(unpacked)) as Held;
    if (!Array.isArray(held.designs) || held.designs.length < 1 || held.designs.length > 2) throw new Error();
  } catch {
    throw new Error("This link holds no design: it was cut or changed on its way.");
  }
  const answers = await Promise.all(held.designs.map((d) => call<Answer>("/api/solve", { tables: d.tables, name: String(d.name) })));
  store.designs = held.designs.map((d, i) => store.make(String(d.name).slice(0, 80), answers[i]));
  store.active = Math.min(Math.max(0, Number(held.active) || 0), store.designs.length - 1);
  return true;
}

async function through(stream: CompressionStream | DecompressionStream, bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array> {
  const flow = new Blob([bytes]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(flow).arrayBuffer());
}
