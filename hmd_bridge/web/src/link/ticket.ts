/** How a page gets in: PROTOCOL.md, Getting in. */
import { RefusedError } from "./failures";

const kTokenKey = "concord-token";

/** What the person typed once; kept by this browser alone. */
export const storedToken = (): string => localStorage.getItem(kTokenKey) ?? "";
export const storeToken = (token: string): void => localStorage.setItem(kTokenKey, token);

/** Rejects where nobody answers. */
export async function ticketNeeded(): Promise<boolean> {
  const response = await fetch("/api/info", { cache: "no-store" }).catch(() => {
    throw new Error("The server does not answer.");
  });
  const info = (await response.json()) as { ticket_needed?: unknown };
  return info.ticket_needed === true;
}

/** Rejects with RefusedError. */
export async function fetchTicket(token: string): Promise<string> {
  const response = await fetch("/api/ticket", { method: "POST", headers: { Authorization: `Bearer ${token}` }, cache: "no-store" });
  if (response.status === 401) throw new RefusedError({ code: "BAD_TOKEN", message: "", retry: false });
  if (response.status === 429) throw new RefusedError({ code: "RATE", message: "Too many tries from this address.", retry: true });
  if (!response.ok) throw new Error(`The server answered ${response.status}.`);
  const { ticket } = (await response.json()) as { ticket?: unknown };
  if (typeof ticket !== "string") throw new Error("The server gave no ticket.");
  return ticket;
}
