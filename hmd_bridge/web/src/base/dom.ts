/** Elements of the page, made in one expression. */
type Attribute = string | number | boolean | ((event: Event) => void);

/** Attributes that begin with "on" are handlers; false leaves one out, true sets it empty. */
export function el<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Record<string, Attribute> = {}, ...children: (Node | string)[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value);
    else if (value !== false) element.setAttribute(name, value === true ? "" : String(value));
  }
  element.append(...children);
  return element;
}

export function button(title: string, act: () => void, attributes: Record<string, Attribute> = {}): HTMLButtonElement {
  return el("button", { type: "button", onclick: act, ...attributes }, title);
}

export function section(title: string, ...children: (Node | string)[]): HTMLElement {
  return el("section", {}, el("h3", {}, title), ...children);
}

/** A line for what there is none of. */
export const none = (text: string): HTMLElement => el("p", { class: "none" }, text);

/** Shows what `make` makes of a value, again at each change; what somebody is typing into it stays. */
export function live(watch: (redraw: () => void) => void, make: () => (Node | string)[], attributes: Record<string, Attribute> = {}): HTMLElement {
  const box = el("div", attributes);
  watch(() => {
    const putBack = typedInto(box);
    box.replaceChildren(...make());
    putBack();
  });
  return box;
}

/** Takes down what was typed into fields, by their labels; the answer writes it into the fields that have these labels then. */
function typedInto(box: HTMLElement): () => void {
  const fields = (): HTMLInputElement[] => [...box.querySelectorAll<HTMLInputElement>("input[aria-label]:not([type=checkbox])")];
  const typed = new Map(fields().filter((one) => one.value !== one.defaultValue).map((one) => [one.ariaLabel, one.value]));
  const writing = box.contains(document.activeElement) ? document.activeElement!.ariaLabel : null;
  return () => {
    for (const one of fields()) {
      one.value = typed.get(one.ariaLabel) ?? one.value;
      if (writing !== null && one.ariaLabel === writing) one.focus();
    }
  };
}

export function field(title: string, control: HTMLElement): HTMLLabelElement {
  return el("label", { class: "field" }, el("span", {}, title), control);
}

export function select(options: readonly { value: string; title: string }[], attributes: Record<string, Attribute> = {}): HTMLSelectElement {
  return el("select", attributes, ...options.map(({ value, title }) => el("option", { value }, title)));
}
