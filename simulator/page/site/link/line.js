// Connection to the program that serves the page: each frame is drawn before the next one is sent.

/** @typedef {{frame: number, state: any}} Frame */
/**
 * frame: receives the newest state. answered: receives answers to messages. changed: receives true if the line is up, and the number of frames left out.
 * @typedef {{frame: (state: any) => void, answered: (answer: any) => void, changed: (up: boolean, left: number) => void}} Ends
 */

const FIRST_WAIT = 500; // ms until the next attempt
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

  /** Sends a message; true if it was sent. @param {any} message */
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

  /** Handles a message. A hidden page draws nothing, and no further frame is sent to it. @param {any} message */
  #heed(message) {
    if (message.do) return this.ends.answered(message);
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
