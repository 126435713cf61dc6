/** How far a device sees each level, and within what number of triangles. */

export interface DetailBudget {
  triangles: number;
  /** Metres, level 0 first: what the device shows if the budget allows. */
  radii: number[];
}

const kFine = 8;
const kMiddle = 20;

/** What headsets draw at their frame rate; a browser on a desk has more to give. */
export function budgetOf(userAgent: string): DetailBudget {
  if (/HoloLens|Windows NT[^)]*ARM/i.test(userAgent)) return { triangles: 400_000, radii: [kFine, kMiddle, 60] };
  if (/OculusBrowser|Quest/i.test(userAgent)) return { triangles: 1_000_000, radii: [kFine, kMiddle, 60] };
  return { triangles: 3_000_000, radii: [20, 50, 200] };
}

const kShrink = 0.8;
const kGrow = 1.1;
const kLeast = 0.1;

/** The radii that were asked for, smaller after a look that was over the budget, larger again well below it. */
export function nextRadii(budget: DetailBudget, radii: readonly number[], triangles: number): number[] {
  const share = radii[0]! / budget.radii[0]!;
  let next = share;
  if (triangles > budget.triangles) next = Math.max(kLeast, share * kShrink);
  else if (triangles < budget.triangles / 2) next = Math.min(1, share * kGrow);
  return budget.radii.map((radius) => Math.round(radius * next * 10) / 10);
}
