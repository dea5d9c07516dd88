// Talking to the server: one request of a kind at a time, the newest wishes win.

export class Refusal extends Error {
  field?: string;
}

export async function call<T>(
  path: string, ask?: unknown, method?: string, signal?: AbortSignal,
): Promise<T> {
  const isText = typeof ask === "string";
  const isFile = ask instanceof Blob;
  let response: Response;
  try {
    response = await fetch(path, {
      method: method ?? (ask === undefined ? "GET" : "POST"),
      headers: ask === undefined ? {} : { "content-type": isText ? "text/plain" : isFile ? ask.type : "application/json" },
      body: ask === undefined ? undefined : isText || isFile ? (ask as string | Blob) : JSON.stringify(ask),
      signal,
    });
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new Refusal("The server does not answer; is microswim studio still running?");
  }
  const kind = response.headers.get("content-type") ?? "";
  const body = kind.includes("json") ? await response.json() : await response.text();
  if (!response.ok) {
    const refusal = new Refusal(body.error ?? `The server answered ${response.status}.`);
    refusal.field = body.field;
    throw refusal;
  }
  return body as T;
}

/** How long (ms) the newest wish waits for the one under way before that is given up. */
const PATIENCE = 400;

/** Sends the newest request once the one under way has come back or has taken too long. */
export class Latest<A, T> {
  private busy = false;
  private since = 0;
  private stop = new AbortController();
  private next: A | null = null;
  sent = 0;
  most = 0;

  constructor(
    private ask: (a: A, signal: AbortSignal) => Promise<T>,
    private done: (answer: T, asked: A, newest: boolean) => void,
    private failed: (error: Error, asked: A) => void,
  ) {}

  send(a: A): void {
    if (this.busy) {
      this.next = a;
      const left = this.since + PATIENCE - performance.now();
      const { stop } = this;
      setTimeout(() => stop.abort(), Math.max(0, left));
      return;
    }
    this.busy = true;
    this.sent += 1;
    this.since = performance.now();
    const stop = (this.stop = new AbortController());
    this.ask(a, stop.signal)
      .then((answer) => this.done(answer, a, this.next === null))
      .catch((error: Error) => stop.signal.aborted || this.failed(error, a))
      .finally(() => {
        this.busy = false;
        const next = this.next;
        this.next = null;
        if (next !== null) this.send(next);
      });
  }

  get idle(): boolean {
    return !this.busy;
  }
}

export function download(name: string, content: Blob | string): void {
  const blob = typeof content === "string" ? new Blob([content], { type: "text/plain" }) : content;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 5000);
}
