/** A value that others watch. */
export class Signal<T> {
  private readonly watchers = new Set<(value: T) => void>();
  constructor(private current: T) {}

  get value(): T {
    return this.current;
  }

  set(value: T): void {
    this.current = value;
    for (const watcher of [...this.watchers]) watcher(value);
  }

  /** Calls `watcher` at once and at each change, until the answer is called. */
  watch(watcher: (value: T) => void): () => void {
    watcher(this.current);
    return this.onChange(watcher);
  }

  /** As watch(), without the first call. */
  onChange(watcher: (value: T) => void): () => void {
    this.watchers.add(watcher);
    return () => this.watchers.delete(watcher);
  }
}
