/** A keyboard as a page of a panel, for names and labels. */
import type { PanelPage } from "./panel_layout";

const kLetters = ["1234567890", "qwertyuiop", "asdfghjkl", "zxcvbnm"];
const kMostLetters = 40;

export function keyboardPage(hint: string, text: string): PanelPage {
  const key = (title: string): { id: string; title: string } => ({ id: `key ${title}`, title });
  return {
    title: hint,
    words: `${text}▏`,
    rows: [
      ...kLetters.map((row) => [...row].map(key)),
      [{ id: "key -", title: "-" }, { id: "key  ", title: "space", share: 3 }, { id: "key back", title: "⌫", share: 2 }],
      [{ id: "text cancel", title: "Cancel" }, { id: "text done", title: "Done", main: true, disabled: text.trim() === "" }],
    ],
  };
}

/** The text after a key. */
export function typed(text: string, id: string): string {
  const key = id.slice("key ".length);
  if (key === "back") return text.slice(0, -1);
  return text.length < kMostLetters ? text + key : text;
}
