/** Rows of buttons on a flat panel: where each lies and which one a point is on. Values in, values out. */
export interface PanelButton {
  id: string;
  title: string;
  /** Share of its row, against the others'. */
  share?: number;
  pressed?: boolean;
  disabled?: boolean;
  main?: boolean;
}

export interface PanelPage {
  title: string;
  /** A line or two of words under the title. */
  words: string;
  rows: PanelButton[][];
}

export interface PlacedButton extends PanelButton {
  /** From the upper left corner, pixels. */
  x: number;
  y: number;
  width: number;
  height: number;
}

export const kPanelWidth = 840;
export const kRowHeight = 84;
export const kHeadHeight = 132;
const kGap = 12;
const kMargin = 20;

export const panelHeight = (page: PanelPage): number => kHeadHeight + page.rows.length * (kRowHeight + kGap) + kMargin;

export function placed(page: PanelPage): PlacedButton[] {
  return page.rows.flatMap((row, r) => {
    const shares = row.reduce((sum, { share = 1 }) => sum + share, 0);
    const room = kPanelWidth - 2 * kMargin - kGap * (row.length - 1);
    let x = kMargin;
    return row.map((button) => {
      const width = (room * (button.share ?? 1)) / shares;
      const at = { ...button, x, y: kHeadHeight + r * (kRowHeight + kGap), width, height: kRowHeight };
      x += width + kGap;
      return at;
    });
  });
}

/** The button at a point; nothing for one that is disabled. */
export function buttonAt(buttons: readonly PlacedButton[], x: number, y: number): PlacedButton | undefined {
  return buttons.find((b) => !b.disabled && x >= b.x && x < b.x + b.width && y >= b.y && y < b.y + b.height);
}
