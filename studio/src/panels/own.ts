// The field of the spec where it is more than one that turns a hard magnet: asked about each place it comes to.

import { call } from "../state/api";
import { fieldAt, holds, type Felt, type Nearby } from "../state/nearby";
import type { Pose, Vec } from "../state/motion";
import type { Answer } from "../state/types";

/** What is known of the field of an answer, from its start and where it was asked since. */
interface Known {
  near: Nearby;
  asking: boolean;
  lost: string;
}

/** share of a box and a while after which the next is asked for */
const SOON = 0.7;

export class Own {
  private known = new WeakMap<Nearby, Known>();

  private of(answer: Answer): Known | null {
    const first = answer.magnet.own;
    if (!first) return null;
    let known = this.known.get(first);
    if (!known) this.known.set(first, (known = { near: first, asking: false, lost: "" }));
    return known;
  }

  has(answer: Answer): boolean {
    return answer.magnet.own !== null;
  }

  restart(answer: Answer): void {
    if (answer.magnet.own) this.known.delete(answer.magnet.own);
  }

  rate(answer: Answer): number {
    return answer.magnet.own?.rate ?? 0;
  }

  felt(answer: Answer, time: number, x: readonly number[]): Felt {
    const known = this.of(answer);
    return known ? fieldAt(known.near, time, x) : { B: [0, 0, 0], J: null };
  }

  knows(answer: Answer, time: number, x: readonly number[]): boolean {
    const known = this.of(answer);
    return known !== null && holds(known.near, time, x);
  }

  /** Why it cannot go on from a pose; "" where it can. Asks for what is not known yet. */
  waits(answer: Answer, pose: Pose, live: boolean): string {
    const known = this.of(answer);
    if (!known || holds(known.near, pose.time, pose.x, SOON)) return "";
    const here = holds(known.near, pose.time, pose.x);
    if (!live) return here ? "" : "What this page has of the field ends here; the studio knows more";
    if (known.lost) return here ? "" : known.lost;
    if (!known.asking) {
      known.asking = true;
      const place: Vec = [...pose.x];
      call<Nearby>("/api/field", { tables: answer.tables, time: pose.time, place })
        .then((near) => (known.near = near))
        .catch((error: Error) => (known.lost = error.message))
        .finally(() => (known.asking = false));
    }
    return here ? "" : "The field of the next piece of the way is being asked";
  }
}
