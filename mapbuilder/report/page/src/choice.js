// What the reader chose: a sub-map, a marker, what is drawn. Views subscribe to it.

export class Choice {
  #listeners = new Map();

  constructor(initial) {
    this.values = { ...initial };
  }

  get(name) {
    return this.values[name];
  }

  set(name, value) {
    if (this.values[name] === value) return;
    this.values[name] = value;
    for (const listener of this.#listeners.get(name) ?? []) listener(value);
  }

  /** Calls `listener` whenever one of the names changes. */
  on(names, listener) {
    for (const name of names) {
      if (!this.#listeners.has(name)) this.#listeners.set(name, []);
      this.#listeners.get(name).push(listener);
    }
  }
}
