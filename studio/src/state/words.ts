// What the server says of fields, units and quantities; src/microswim/studio/words.py sends it.

export interface Field {
  kind: "quantity" | "number" | "truth" | "word" | "text";
  label: string;
  help: string;
  /** what the entries of a list are called */
  entries: string[];
  /** where a slider runs, if that does not depend on the design */
  usual: [number, number] | null;
  /** the words that are allowed, and what they are called */
  choices: [string, string][];
  /** what words are called that one cannot choose here */
  called: Record<string, string>;
}

export interface Quantity {
  label: string;
  /** SI; empty for a plain number */
  unit: string;
  meaning: string;
}

export interface Words {
  fields: Record<string, Field>;
  /** size of each unit in SI */
  units: Record<string, number>;
  quantities: Record<string, Quantity>;
  /** units in which people read an SI unit: name, size, least value that is read in it; falling */
  read_in: Record<string, [string, number, number][]>;
  /** quantities that a map can show */
  outputs: string[];
  /** numbers that a map is first drawn over, the dearest first */
  axes: string[];
  /** degrees off the field's axis: up to the first it turns straight, from the second on it tumbles */
  lean: [number, number];
  /** resolutions of the judge */
  levels: string[];
  /** body, tail and path of each swimmer, and a map's values from the least to the largest */
  palette: { swimmers: [string, string, string][]; map: string[] };
  /** bytes of a spec file */
  largest: number;
  /** endings of files that hold a surface, and of those that hold tracks or a beat */
  surfaces: string[];
  films: string[];
  /** units of length */
  lengths: string[];
}

let told: Words = { fields: {}, units: {}, quantities: {}, read_in: {}, outputs: [], axes: [], lean: [0, 0], levels: [], palette: { swimmers: [], map: [] }, largest: 0, surfaces: [], films: [], lengths: [] };

export function learn(words: Words): void {
  told = words;
}

export const words = (): Words => told;

/** A field's name without the number of its tail. */
export const plain = (path: string): string => path.replace(/^(\w+)\[\d+\]\./, "$1.");

/** What is known of a field; an entry of a list is one of its field. */
export function field(path: string): Field | undefined {
  return told.fields[plain(path).replace(/\[.*$/, "")];
}

export function size(unit: string): number {
  return told.units[unit] ?? 1;
}

/** What a quantity is called, its unit and meaning. */
export function called(name: string): Quantity {
  return told.quantities[name] ?? { label: name.replace(/_/g, " "), unit: "", meaning: "" };
}
