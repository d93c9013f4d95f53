// Proved values in a web page, to any digits that are certified. Written by `driftproof value --only '*' --format js`.
//
//   import { define, digits, value } from "./driftproof.mjs";
//   digits("rk4.first_step.q", 6);   // "0.877604"
//   value("rk4.first_step.q").exact; // "337/384"
//   define();                        // now <driftproof-value of="rk4.first_step.q" digits="6"></driftproof-value> shows it
//
// No number here is a float: decimals are strings and are rounded as integers, half-even, as the proofs round them.

/** id -> { exact, decimal, evidence, printed }; `exact` is null where a number has no short exact form. */
export const values = {};

/** Take the values of a JSON file, as `driftproof value --only '*'` writes it, in place of these. Throws where it holds none. */
export async function load(url) {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`driftproof: ${url}: ${answer.status} ${answer.statusText}`);
  const document = await answer.json();
  if (!(document?.values instanceof Object)) throw new Error(`driftproof: ${url} holds no values`);
  for (const id of Object.keys(values)) delete values[id];
  Object.assign(values, document.values);
}

/** The value with this id. Throws where there is none. */
export function value(id) {
  if (!Object.hasOwn(values, id)) throw new Error(`driftproof: no value has the id ${JSON.stringify(id)}`);
  return values[id];
}

/** The number, correctly rounded to n significant digits. Throws for an unknown id, and for digits nobody certified. */
export function digits(id, n) {
  demand(n, 1, "digits");
  const x = number(id);
  if (x.top === 0n) return "0";
  let decade = length(x.top / x.bottom) - 1;
  if (decade < 0) decade = length(x.top) - length(x.bottom); // at most one too large
  if (x.top * tenTo(-decade) < x.bottom * tenTo(decade)) decade -= 1;
  let rounded = String(inUnits(x, decade - n + 1, id));
  if (rounded.length > n) {
    decade += 1;
    rounded = rounded.slice(0, n);
  }
  const sign = x.negative ? "-" : "";
  if (-5 <= decade && decade < n) return sign + pointed(rounded, n - 1 - decade);
  return `${sign}${pointed(rounded, n - 1)}e${decade}`;
}

/** The number, correctly rounded to n digits after the point. A zero has no sign. Throws as `digits` does. */
export function places(id, n) {
  demand(n, 0, "places");
  const x = number(id);
  const rounded = inUnits(x, -n, id);
  return (x.negative && rounded !== 0n ? "-" : "") + pointed(String(rounded), n);
}

const MOST_DIGITS = 10000;
const RATIONAL = /^(-?)(\d+)(?:\/(\d+))?$/;
const DECIMAL = /^(-?)(\d+)(?:\.(\d+))?(?:e([+-]?\d{1,4}))?$/;

function demand(n, least, what) {
  if (Number.isInteger(n) && least <= n && n <= MOST_DIGITS) return;
  throw new Error(`driftproof: ${what} is ${String(n)}; it must be a whole number from ${least} to ${MOST_DIGITS}`);
}

/** |x| as top / bottom; `last` is the power of ten of the last certified digit, null where the rational is x itself. */
function number(id) {
  const { exact, decimal } = value(id);
  const rational = RATIONAL.exec(exact ?? "");
  if (rational) {
    return { negative: rational[1] !== "", top: BigInt(rational[2]), bottom: BigInt(rational[3] ?? "1"), last: null };
  }
  const match = DECIMAL.exec(decimal ?? "");
  if (!match) throw new Error(`driftproof: ${id} is no number and has no digits`);
  const [, sign, whole, part = "", exponent = "0"] = match;
  const last = Number(exponent) - part.length;
  return { negative: sign !== "", top: BigInt(whole + part) * tenTo(last), bottom: tenTo(-last), last };
}

/** 10^power as an integer, 1 for a negative power. */
function tenTo(power) {
  return power > 0 ? 10n ** BigInt(power) : 1n;
}

function length(integer) {
  return integer === 0n ? 0 : String(integer).length;
}

/**
 * |x| / 10^power, rounded to an integer, a tie to the even one.
 *
 * A decimal stands for a number up to half a unit of its last digit away, so it rounds as that number does to any
 * coarser unit, unless it lies half-way itself: then nobody certified on which side the number is.
 */
function inUnits(x, power, id) {
  if (x.last !== null && power < x.last) throw new Error(`driftproof: ${id} is not certified to so many digits`);
  const top = x.top * tenTo(-power);
  const bottom = x.bottom * tenTo(power);
  const floor = top / bottom;
  const twice = 2n * (top - floor * bottom);
  if (twice === bottom && x.last !== null) {
    throw new Error(`driftproof: ${id} is half-way in the digits that are certified; ask for one digit more or less`);
  }
  return twice > bottom || (twice === bottom && floor % 2n === 1n) ? floor + 1n : floor;
}

function pointed(integer, places) {
  const padded = integer.padStart(places + 1, "0");
  return places === 0 ? padded : `${padded.slice(0, -places)}.${padded.slice(-places)}`;
}

// An exact form longer than this is left out of the remark, which then shows the certified decimal.
const LONGEST_SHOWN = 60;
const WORDS = { GIVEN: "given", PROVED: "proved", CERTIFIED: "certified", COUNTED: "counted" };
// System colours follow the page's own color-scheme, light or dark.
const STYLE = `
driftproof-value { position: relative; display: inline-block; }
driftproof-value > data { border-bottom: 1px dotted; cursor: help; }
driftproof-value > [role="tooltip"] {
  position: absolute; z-index: 1; left: var(--shift, 0px); top: 100%; box-sizing: border-box;
  width: max-content; max-width: min(24rem, 90vw);
  padding: 0.25em 0.5em; border: 1px solid; border-radius: 0.25em; display: none;
  background: Canvas; color: CanvasText; overflow-wrap: anywhere; font: 0.875rem/1.4 system-ui, sans-serif;
}
driftproof-value.open > [role="tooltip"] { display: block; }
driftproof-value > [role="alert"] { color: #fff; background: #b00020; padding: 0 0.25em; }
`;

/** The remark on a value: its exact form if that is short, else its certified decimal; and its evidence. */
export function remark(id) {
  const { exact, decimal, evidence } = value(id);
  const shown = exact !== null && exact.length <= LONGEST_SHOWN ? `= ${exact}` : `≈ ${decimal}`;
  return `${shown}, ${WORDS[evidence] ?? evidence}`;
}

/**
 * Define <driftproof-value of="ID" digits="N"> (or places="N"), once, in a page.
 *
 * The element shows the number, and its remark while the pointer is on it or it has the focus; Escape closes the remark.
 * An unknown id, or digits that are not certified, are shown in its place as an error. What the page holds inside the
 * element is shown only where no script runs.
 */
export function define() {
  if (customElements.get("driftproof-value")) return;
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(STYLE);
  document.adoptedStyleSheets = [...document.adoptedStyleSheets, sheet];
  customElements.define("driftproof-value", elementClass());
}

let remarks = 0;

function elementClass() {
  return class extends HTMLElement {
    static observedAttributes = ["of", "digits", "places"];

    connectedCallback() {
      this.addEventListener("pointerenter", () => this.open(true));
      this.addEventListener("pointerleave", () => this.open(this.contains(document.activeElement)));
      this.addEventListener("focusin", () => this.open(true));
      this.addEventListener("focusout", () => this.open(false));
      this.addEventListener("keydown", (event) => event.key === "Escape" && this.open(false));
      this.show();
    }

    attributeChangedCallback() {
      if (this.isConnected) this.show();
    }

    open(wanted) {
      this.classList.toggle("open", wanted);
      this.style.setProperty("--shift", "0px");
      const beyond = this.lastElementChild.getBoundingClientRect().right - document.documentElement.clientWidth;
      this.style.setProperty("--shift", `${Math.min(0, -Math.ceil(beyond))}px`);
    }

    show() {
      try {
        this.replaceChildren(...shown(this.getAttribute("of"), this.getAttribute("digits"), this.getAttribute("places")));
      } catch (error) {
        this.replaceChildren(element("span", { role: "alert" }, error.message));
      }
    }
  };
}

function shown(id, n, p) {
  if (id === null) throw new Error("driftproof: an element needs the attribute of, the id of a value");
  if ((n === null) === (p === null)) throw new Error(`driftproof: ${id} needs either the attribute digits or places`);
  const text = n === null ? places(id, whole(p)) : digits(id, whole(n));
  const tip = `driftproof-remark-${(remarks += 1)}`;
  const attributes = { value: value(id).decimal, tabindex: "0", "aria-describedby": tip };
  return [element("data", attributes, text), element("span", { role: "tooltip", id: tip }, remark(id))];
}

function whole(text) {
  return /^\d{1,6}$/.test(text) ? Number(text) : text;
}

function element(name, attributes, text) {
  const made = document.createElement(name);
  for (const [key, word] of Object.entries(attributes)) made.setAttribute(key, word);
  made.textContent = text;
  return made;
}
