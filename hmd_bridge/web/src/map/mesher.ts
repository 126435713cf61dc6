/** Hands blocks to workers; of a block that changes meanwhile only the newest mesh counts. */
import type { MeshDone, MeshJob } from "./mesh_job";

export interface MeshWorker {
  postMessage(job: MeshJob, transfer: ArrayBuffer[]): void;
  onmessage: ((event: MessageEvent<MeshDone>) => void) | null;
}

interface Waiting {
  make: () => Omit<MeshJob, "job"> | null;
  done: (mesh: MeshDone | null) => void;
}

export class Mesher {
  private readonly waiting = new Map<string, Waiting>();
  private readonly running = new Map<number, (mesh: MeshDone) => void>();
  private readonly idle: MeshWorker[];
  private jobs = 0;

  constructor(workers: MeshWorker[]) {
    this.idle = [...workers];
    for (const worker of workers) {
      worker.onmessage = ({ data }) => {
        const take = this.running.get(data.job);
        this.running.delete(data.job);
        this.idle.push(worker);
        take?.(data);
        this.pump();
      };
    }
  }

  /** Whether nothing waits and nothing runs. */
  get settled(): boolean {
    return this.waiting.size === 0 && this.running.size === 0;
  }

  /**
   * Meshes what `make` makes once a worker is free; a later call with the same name takes its place while it waits.
   * `done` hears null if there was nothing to mesh by then.
   */
  mesh(name: string, make: Waiting["make"], done: Waiting["done"]): void {
    this.waiting.set(name, { make, done });
    this.pump();
  }

  private pump(): void {
    for (const [name, { make, done }] of this.waiting) {
      const worker = this.idle.pop();
      if (!worker) return;
      this.waiting.delete(name);
      const job = make();
      if (!job) {
        this.idle.push(worker);
        done(null);
        continue;
      }
      const number = ++this.jobs;
      this.running.set(number, done);
      worker.postMessage({ ...job, job: number }, [job.chunks.buffer, job.cells.buffer, job.borders.buffer]);
    }
  }
}
