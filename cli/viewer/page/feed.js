// SPDX-License-Identifier: Apache-2.0
// The messages of a server that is observed, as long as there is one.
const pause = 1000;  // ms before the next try
const tooSlow = 1013;

export class Feed {
  #react;
  #text = null;  // what the server said last about its end

  // in  react  {open(), message(object), closed(text)}
  constructor(address, react) {
    this.address = address;
    this.#react = react;
    this.#open();
  }

  #open() {
    const socket = new WebSocket(this.address);
    let wasOpen = false;
    this.#text = null;
    socket.addEventListener("open", () => (wasOpen = true, this.#react.open()));
    socket.addEventListener("message", ({data}) => {
      const message = JSON.parse(data);
      if (message.end === undefined) this.#react.message(message);
      else this.#text = message.end;
    });
    socket.addEventListener("close", ({code}) => {
      if (wasOpen) this.#react.closed(this.#text ?? (code === tooSlow ? "this page was too slow" : "the connection is lost"));
      setTimeout(() => this.#open(), pause);
    });
  }
}
