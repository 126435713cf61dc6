/** Values that outlive the page: a reload loses nothing that somebody made and did not send yet. */
import { Signal } from "./signal";

export type Store = Pick<Storage, "getItem" | "setItem">;

/** A signal whose value is written to `store` at each change, and follows what another tab writes there. @param good whether what is found there is of its kind; else it begins as `first` */
export function kept<T>(store: Store, key: string, first: T, good: (value: unknown) => value is T): Signal<T> {
  const found = parsed(store.getItem(key));
  const signal = new Signal(good(found) ? found : first);
  signal.onChange((value) => store.setItem(key, JSON.stringify(value)));
  globalThis.addEventListener?.("storage", (event) => {
    const { storageArea, key: changed, newValue } = event as StorageEvent;
    if (storageArea !== store || changed !== key) return;
    const value = parsed(newValue);
    signal.set(good(value) ? value : first);
  });
  return signal;
}

function parsed(text: string | null): unknown {
  try {
    return text === null ? undefined : JSON.parse(text);
  } catch {
    return undefined;  // not written by this page, or by another version of it
  }
}
