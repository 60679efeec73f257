// The line to the program that serves the page: frames in, each drawn before the next one is sent.

/** @typedef {{frame: number, state: any}} Frame */
/**
 * frame: is given the newest state. told: answers to what was said. changed: whether the line is up, and how many frames were left out.
 * @typedef {{frame: (state: any) => void, told: (answer: any) => void, changed: (up: boolean, left: number) => void}} Ends
 */

const FIRST_WAIT = 500; // ms until it is tried again
const LONGEST_WAIT = 4000;

export class Line {
  /** @param {Ends} ends */
  constructor(ends) {
    this.ends = ends;
    this.wait = FIRST_WAIT;
    this.latest = 0;
    this.left = 0;
    this.#open();
  }

  /** Whether it went out. @param {any} message */
  say(message) {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  #open() {
    const address = new URL("/link", location.href);
    address.protocol = "ws:";
    address.search = location.search;
    const socket = new WebSocket(address);
    this.socket = socket;
    socket.addEventListener("open", () => {
      this.wait = FIRST_WAIT;
      this.latest = 0;
      this.ends.changed(true, this.left);
    });
    socket.addEventListener("message", (event) => this.#heed(JSON.parse(event.data)));
    socket.addEventListener("close", () => {
      this.ends.changed(false, this.left);
      setTimeout(() => this.#open(), this.wait);
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    });
  }

  /** A page that is not looked at draws nothing, and is sent nothing. @param {any} message */
  #heed(message) {
    if (message.do) return this.ends.told(message);
    requestAnimationFrame(() => {
      if (this.latest && message.frame > this.latest + 1) {
        this.left += message.frame - this.latest - 1;
        this.ends.changed(true, this.left);
      }
      this.latest = message.frame;
      this.ends.frame(message.state);
      this.say({ do: "seen", frame: message.frame });
    });
  }
}
