'use strict';
// The server of a live page.

const RETRY_PERIOD = 1000;

class Connection {
  constructor(onMessages, onState) {
    this.onMessages = onMessages;
    this.onState = onState;
    this.open();
  }

  open() {
    const url = new URL('socket', window.location.href);
    url.protocol = url.protocol.replace('http', 'ws');
    url.search = window.location.search;  // with the token, where there is one
    this.socket = new WebSocket(url);
    this.socket.addEventListener('open', () => this.onState(true));
    this.socket.addEventListener('message', (event) => this.onMessages(JSON.parse(event.data)));
    this.socket.addEventListener('close', () => {
      this.onState(false);
      setTimeout(() => this.open(), RETRY_PERIOD);
    });
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}
