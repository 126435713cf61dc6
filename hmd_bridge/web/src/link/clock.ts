/** The server's time, from answers to clock requests: of those heard, the one with the shortest way counts. */
export class ServerClock {
  private offset = 0;
  private shortest = Infinity;

  /** @param sent, received this machine's clock, milliseconds; @param arrived, answered the server's, microseconds */
  hear(sent: number, arrived: number, answered: number, received: number): void {
    const way = received - sent - (answered - arrived) / 1000;
    // An old measurement slowly gives way to newer ones: clocks drift.
    this.shortest *= 1.1;
    if (way > this.shortest) return;
    this.shortest = way;
    this.offset = (arrived + answered) / 2 - ((sent + received) / 2) * 1000;
  }

  /** Microseconds since 1970 on the server, given this machine's milliseconds. */
  utime(now: number): number {
    return Math.round(now * 1000 + this.offset);
  }
}
