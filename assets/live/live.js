// The script of the live page: it shows the film while it is simulated, and sends what is grabbed, turned and changed.
"use strict";

const shortest_pause_ms = 500, longest_pause_ms = 10000;  // between attempts to reach the program
const busy_pause_ms = 150;                                // after the program said that there is too much to do
const graph_frames = 300;
const slowest = 0.05, fastest = 4;  // factors of the film's speed

const claim_key = `writer of ${location.pathname}`;  // in the session's storage, so that a claim survives a reload

const page = {
  watches: new URLSearchParams(location.search).has("watch"),  // asked for by the address
  writer: sessionStorage.getItem(claim_key),
  wants_to_steer: true,
  hello: null,
  state: null,
  ended: "",           // the text of the event `end`
  unsaved: sessionStorage.getItem(claim_key) !== null,  // something was done that no saved replay has
  history: [],         // the last frames' numbers
  touch: null,         // {input, at} of an input that no picture has shown yet
  touch_ms: null,      // how long the last one took to be seen
};

// ---- Small things ----

const by_id = id => document.getElementById(id);
const sleep = ms => new Promise(resolve => setTimeout(resolve, ms));
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

function make(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

// Writes only what differs, so that screen readers are not told the same twice.
function write(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

function short_number(value, digits = 3) {
  const size = Math.abs(value);
  if (size !== 0 && (size < 0.001 || size >= 1e6)) return value.toExponential(1);
  return String(Number(value.toPrecision(digits)));
}

// Shows a remark for a while, or until the next one where it tells of a refusal.
let remark_timer = 0;
function remark(text, stays = false) {
  write(by_id("remark"), text);
  clearTimeout(remark_timer);
  if (!stays) remark_timer = setTimeout(() => write(by_id("remark"), ""), 8000);
}

const steers = () => page.hello !== null && page.hello.writer;

// ---- What is sent ----

class Refusal extends Error {
  constructor(status, text) {
    super(text);
    this.status = status;
  }
}

const unreachable = "The program has ended or cannot be reached.";

async function error_text(answer) {
  try {
    return (await answer.json()).error || `The program answered ${answer.status}.`;
  } catch (error) {
    return `The program answered ${answer.status}.`;
  }
}

async function send(command) {
  const at = performance.now();
  let answer;
  try {
    answer = await fetch("./do", {
      method: "POST",
      headers: { "Content-Type": "application/json", "X-Writer": page.writer || "" },
      body: JSON.stringify(command),
    });
  } catch (error) {
    throw new Refusal(0, unreachable);
  }
  if (answer.status === 403) lose_claim();
  if (!answer.ok) throw new Refusal(answer.status, await error_text(answer));
  const taken = await answer.json();
  if (!page.touch) page.touch = { input: taken.input, at };
  return taken;
}

// Sends a command that nothing newer replaces: waits while the program has too much to do.
async function send_patiently(command) {
  for (let tries = 1; ; ++tries) {
    try {
      return await send(command);
    } catch (refusal) {
      if (refusal.status !== 429 || tries === 10) throw refusal;
      await sleep(busy_pause_ms * tries);
    }
  }
}

// Sends a button's command, and says in words why it was refused. Returns the answer, or null.
async function order(command) {
  try {
    return await send_patiently(command);
  } catch (refusal) {
    remark(refusal.message, true);
    return null;
  }
}

// Sends one command at a time, and then the newest that came meanwhile: the program sets the pace.
class Lane {
  constructor({ taken = () => {}, refused = refusal => remark(refusal.message, true), settled = () => {} } = {}) {
    Object.assign(this, { taken, refused, settled, next: null, running: null });
  }

  send(command) {
    this.next = command;
    if (!this.running) this.running = this.run();
  }

  async run() {
    while (this.next) {
      const command = this.next;
      this.next = null;
      try {
        this.taken(command, await send(command));
      } catch (refusal) {
        if (refusal.status === 429) {
          this.next = this.next || command;
          await sleep(busy_pause_ms);
        } else {
          this.refused(refusal);
        }
      }
    }
    this.running = null;
    this.settled();
  }

  async idle() {
    await this.running;
  }
}

// ---- The view ----

const view_moves = { orbit: [0, 0], pan: [0, 0], zoom: 1, running: false };

// Moves that come while one is under way add up to the next one.
function move_view(kind, by) {
  if (kind === "zoom") view_moves.zoom *= by;
  else view_moves[kind] = view_moves[kind].map((sum, i) => sum + by[i]);
  if (!view_moves.running) send_view_moves();
}

// Takes as much of the moves that have added up as one command may have.
function next_view_move() {
  for (const [kind, most] of [["orbit", 180], ["pan", 5]]) {
    if (!view_moves[kind].some(Boolean)) continue;
    const by = view_moves[kind].map(value => clamp(value, -most, most));
    view_moves[kind] = view_moves[kind].map((value, i) => value - by[i]);
    return { do: kind, by };
  }
  const by = clamp(view_moves.zoom, 0.2, 5);
  view_moves.zoom /= by;
  return by === 1 ? null : { do: "zoom", by };
}

async function send_view_moves() {
  view_moves.running = true;
  for (let command = next_view_move(); command; command = next_view_move()) {
    try {
      await send(command);
    } catch (refusal) {
      if (refusal.status === 429) {
        move_view(command.do, command.by);
        await sleep(busy_pause_ms);
      } else {
        remark(refusal.message, true);
      }
    }
  }
  view_moves.running = false;
}

// ---- Grabbing ----

let last_drop = Promise.resolve();  // a new grab waits until the last one has been let go

class Grab {
  constructor(at) {
    this.at = at;
    this.asked_at = at;
    this.body = null;     // its name, once it is held
    this.over = false;
    this.lane = new Lane();
    this.asked = this.ask();
  }

  // Returns whether something was there.
  async ask() {
    await last_drop;
    try {
      this.body = (await send_patiently({ do: "grab", ...this.asked_at })).body;
    } catch (refusal) {
      if (refusal.status !== 422) remark(refusal.message, true);
      return false;
    }
    page.unsaved = true;
    if (this.at !== this.asked_at) this.move(this.at);
    return true;
  }

  move(at) {
    this.at = at;
    if (this.body !== null) this.lane.send({ do: "drag", ...at });
  }

  drop(pins) {
    if (this.over) return;
    this.over = true;
    last_drop = this.let_go(pins);
  }

  async let_go(pins) {
    if (!await this.asked) return;
    await this.lane.idle();
    const taken = await order(pins ? { do: "drop", pin: true } : { do: "drop" });
    if (taken && pins) remark(`Pinned ${this.body}.`);
  }
}

const picture = by_id("picture");

function place_mark(mark, at) {
  mark.style.setProperty("--x", `${100 * at.x}%`);
  mark.style.setProperty("--y", `${100 * at.y}%`);
  mark.hidden = false;
}

const pins_on_drop = () => by_id("pin").getAttribute("aria-pressed") === "true";

function toggle_pin() {
  by_id("pin").setAttribute("aria-pressed", String(!pins_on_drop()));
}

// ---- Mouse, touch and pen ----

const pointers = new Map();  // those that are down, by their id: {x, y} in CSS pixels
let gesture = null;          // {kind, grab, start}; kind: "grab", "orbit", "pan", "pinch", or "done" until all are up

function share_of_picture(point) {
  const box = picture.getBoundingClientRect();
  return { x: clamp((point.x - box.left) / box.width, 0, 1), y: clamp((point.y - box.top) / box.height, 0, 1) };
}

// The scene follows the pointer: half a turn over the picture's height.
function orbit_by_pixels(dx, dy) {
  const degrees = 180 / picture.clientHeight;
  move_view("orbit", [-dx * degrees, dy * degrees]);
}

function pan_by_pixels(dx, dy) {
  move_view("pan", [dx / picture.clientHeight, -dy / picture.clientHeight]);
}

function kind_of_gesture(event) {
  if (event.button === 1 || event.shiftKey) return "pan";
  return event.button === 2 || event.altKey ? "orbit" : "grab";
}

function pointer_down(event) {
  if (!steers() || pointers.size === 2) return;
  picture.setPointerCapture(event.pointerId);
  const point = { x: event.clientX, y: event.clientY };
  pointers.set(event.pointerId, point);
  if (pointers.size === 2) begin_pinch();
  else begin_gesture(kind_of_gesture(event), point);
}

function begin_gesture(kind, point) {
  leave_crosshair();
  gesture = { kind, grab: null, start: point };
  if (kind === "grab") follow_grab(gesture, point);
}

// Where nothing is there to be grabbed, the same gesture turns the view.
async function follow_grab(begun, point) {
  begun.grab = new Grab(share_of_picture(point));
  begun.last = point;
  const held = await begun.grab.asked;
  if (!held && begun.kind === "grab") {
    begun.kind = "orbit";
    orbit_by_pixels(begun.last.x - begun.start.x, begun.last.y - begun.start.y);
  }
  if (held && !begun.grab.over) {
    picture.classList.add("holds");
    place_mark(by_id("ring"), begun.grab.at);
  }
}

function end_grab(pins) {
  if (gesture && gesture.kind === "grab") gesture.grab.drop(pins);
  picture.classList.remove("holds");
  by_id("ring").hidden = true;
}

function begin_pinch() {
  end_grab(false);
  gesture = { kind: "pinch", ...pinch() };
}

function pinch() {
  const [a, b] = [...pointers.values()];
  return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.max(1, Math.hypot(a.x - b.x, a.y - b.y)) };
}

function pointer_move(event) {
  const before = pointers.get(event.pointerId);
  if (!before) return;
  const point = { x: event.clientX, y: event.clientY };
  const dx = point.x - before.x, dy = point.y - before.y;
  pointers.set(event.pointerId, point);
  if (dx === 0 && dy === 0) return;
  if (gesture.kind === "orbit") orbit_by_pixels(dx, dy);
  if (gesture.kind === "pan") pan_by_pixels(dx, dy);
  if (gesture.kind === "pinch") move_pinch();
  if (gesture.kind === "grab") move_grab(point);
}

function move_grab(point) {
  gesture.last = point;
  gesture.grab.move(share_of_picture(point));
  if (gesture.grab.body !== null) place_mark(by_id("ring"), gesture.grab.at);
}

function move_pinch() {
  const now = pinch();
  pan_by_pixels(now.x - gesture.x, now.y - gesture.y);
  if (now.size !== gesture.size) move_view("zoom", now.size / gesture.size);
  Object.assign(gesture, now);
}

function pointer_up(event) {
  if (!pointers.delete(event.pointerId)) return;
  end_grab(pins_on_drop());
  if (pointers.size > 0) gesture = { kind: "done" };
}

function zoom_by_wheel(event) {
  if (!steers()) return;
  event.preventDefault();
  const pixels = event.deltaY * [1, 33, 400][event.deltaMode];
  if (pixels !== 0) move_view("zoom", Math.exp(-pixels * (event.ctrlKey ? 0.01 : 0.0015)));
}

function listen_to_picture() {
  picture.addEventListener("pointerdown", pointer_down);
  picture.addEventListener("pointermove", pointer_move);
  picture.addEventListener("pointerup", pointer_up);
  picture.addEventListener("pointercancel", pointer_up);
  picture.addEventListener("wheel", zoom_by_wheel, { passive: false });
  picture.addEventListener("contextmenu", event => event.preventDefault());
  picture.addEventListener("mousedown", event => { if (event.button !== 0) event.preventDefault(); });
}

// ---- Grabbing by keys ----

const crosshair = { on: false, x: 0.5, y: 0.5, grab: null };

function enter_crosshair() {
  if (!steers()) return;
  Object.assign(crosshair, { on: true, x: 0.5, y: 0.5, grab: null });
  place_mark(by_id("crosshair"), crosshair);
  by_id("keyboard-grab").setAttribute("aria-pressed", "true");
  picture.focus();
  remark("Arrows move the crosshair, Enter grabs, P pins, Escape leaves.");
}

function leave_crosshair() {
  if (!crosshair.on) return;
  end_crosshair_grab(false);
  crosshair.on = false;
  by_id("crosshair").hidden = true;
  by_id("keyboard-grab").setAttribute("aria-pressed", "false");
}

function toggle_crosshair() {
  if (crosshair.on) leave_crosshair();
  else enter_crosshair();
}

function move_crosshair(dx, dy) {
  crosshair.x = clamp(crosshair.x + dx, 0, 1);
  crosshair.y = clamp(crosshair.y + dy, 0, 1);
  place_mark(by_id("crosshair"), crosshair);
  if (crosshair.grab) crosshair.grab.move({ x: crosshair.x, y: crosshair.y });
}

async function begin_crosshair_grab() {
  const grab = new Grab({ x: crosshair.x, y: crosshair.y });
  crosshair.grab = grab;
  const held = await grab.asked;
  if (crosshair.grab !== grab) return;
  if (!held) crosshair.grab = null;
  by_id("crosshair").classList.toggle("holds", held);
  remark(held ? `Holding ${grab.body}: arrows pull, Enter lets go, P pins.` : "Nothing is there.");
}

function end_crosshair_grab(pins) {
  if (!crosshair.grab) return;
  crosshair.grab.drop(pins);
  crosshair.grab = null;
  by_id("crosshair").classList.remove("holds");
  if (!pins) remark("Let go.");
}

function press_enter() {
  if (!crosshair.on) return false;
  if (crosshair.grab) end_crosshair_grab(pins_on_drop());
  else begin_crosshair_grab();
  return true;
}

// Pins what is held now. The button does the same for hands without a key.
function pin_now() {
  if (crosshair.grab) {
    end_crosshair_grab(true);
  } else if (gesture && gesture.kind === "grab" && pointers.size > 0) {
    end_grab(true);
    gesture = { kind: "done" };
  }
}

// ---- Keys ----

const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

function press_arrow(event) {
  const [x, y] = arrows[event.key];
  const step = event.shiftKey ? 0.005 : 0.02;
  if (crosshair.on) move_crosshair(x * step, y * step);
  else if (event.shiftKey) move_view("pan", [x * 0.05, -y * 0.05]);
  else move_view("orbit", [-x * 5, y * 5]);
}

const keys_that_steer = {
  " ": () => toggle_pause(),
  ".": () => order({ do: "step" }),
  "[": () => change_speed(0.5),
  "]": () => change_speed(2),
  "+": () => move_view("zoom", 1.15),
  "=": () => move_view("zoom", 1.15),
  "-": () => move_view("zoom", 1 / 1.15),
  Home: () => order({ do: "home" }),
  r: () => restart(),
  f: () => show_next_field(),
  w: () => order({ do: "show", wireframe: !page.state.wireframe }),
  p: () => pin_now(),
  g: () => toggle_crosshair(),
  ...Object.fromEntries(Object.keys(arrows).map(key => [key, press_arrow])),
};

const keys_for_all = {
  s: () => save(),
  "/": () => by_id("search").focus(),
  "?": () => by_id("help-dialog").showModal(),
};

// Tells whether the element with the focus has a use of its own for the key.
function belongs_to_focus(event) {
  const { target, key } = event;
  if (target === picture || !(target instanceof Element)) return false;
  if (target.matches("input[type=range]")) return key in arrows || /^(Home|End|Page.*)$/.test(key);
  if (target.matches("select, textarea, input:not([type=checkbox], [type=color])")) return true;
  return target.matches("button, summary, input") && (key === " " || key === "Enter");
}

function press_key(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
  if (event.key === "Escape") {
    by_id("view-menu").open = false;
    leave_crosshair();
    return;
  }
  if (belongs_to_focus(event)) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (event.repeat && !(key in arrows || "+-=".includes(key))) return event.preventDefault();  // a key that is held
  if (key === "Enter") {
    if (press_enter()) event.preventDefault();
    return;
  }
  if (!by_id("single-keys").checked && event.target !== picture) return;
  const action = keys_for_all[key] || (steers() && keys_that_steer[key]);
  if (!action) return;
  event.preventDefault();
  action(event);
}

// ---- Running, time travel, saving ----

function toggle_pause() {
  order({ do: page.state.paused ? "run" : "pause" });
}

function change_speed(factor) {
  const speed = clamp(page.state.speed * factor, slowest, fastest);
  if (speed === page.state.speed) return;
  page.state.speed = speed;  // so that the next press starts from it, before the program has answered
  show_state();
  order({ do: "speed", factor: speed });
}

function show_next_field() {
  const fields = page.hello.fields;
  order({ do: "show", field: fields[(fields.indexOf(page.state.field) + 1) % fields.length] });
}

// Asks before something is lost. Returns whether to go on.
async function may_forget(heading, text) {
  if (!page.unsaved) return true;
  const dialog = by_id("ask");
  write(by_id("ask-heading"), heading);
  write(by_id("ask-text"), text);
  dialog.returnValue = "";
  dialog.showModal();
  await new Promise(resolve => dialog.addEventListener("close", resolve, { once: true }));
  return dialog.returnValue === "go" || (dialog.returnValue === "save" && save());
}

async function restart() {
  if (!await may_forget("Start again?", "All changes, grabs and pins of this session will be forgotten.")) return;
  if (await order({ do: "restart" })) page.unsaved = false;
}

async function go_back() {
  const frame = Number(by_id("timeline").value);
  if (!await may_forget(`Go back to frame ${frame}?`, "What was done after this frame will be forgotten.")) return;
  if (!await order({ do: "go", frame })) return;
  chooses_frame = false;
}

function download(name, text) {
  const address = URL.createObjectURL(new Blob([text], { type: "application/toml" }));
  make("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60000);
}

// Returns whether the replay was saved.
async function save() {
  let saved;
  remark("Saving …", true);
  try {
    const answer = await fetch("./replay");
    if (!answer.ok) throw new Refusal(answer.status, await error_text(answer));
    saved = await answer.json();
  } catch (error) {
    remark(`Nothing was saved. ${error instanceof Refusal ? error.message : unreachable}`);
    return false;
  }
  download(saved.name, saved.replay);
  if (saved.scene) download(saved.scene_name, saved.scene);
  page.unsaved = false;
  const both = `Saved two files: the replay ${saved.name} and its scene ${saved.scene_name}. Keep them together.`;
  const film = ` The film of it: supple replay ${saved.name}.`;
  const view = page.state.own_view ? " It has the scene's camera, unless View, Keep this view for the film is pressed." : "";
  remark((saved.scene ? both : `Saved ${saved.name}.`) + film + view, true);
  return true;
}

let chooses_frame = false;  // the timeline stands where it was put, and does not follow the film

function show_time() {
  const { first, last, frame } = page.state, timeline = by_id("timeline");
  timeline.min = first;
  timeline.max = last;
  if (!chooses_frame && document.activeElement !== timeline) timeline.value = frame;
  const chosen = Number(timeline.value);
  if (chooses_frame) timeline.setAttribute("aria-valuetext", `Frame ${chosen}`);
  write(by_id("go-back"), chooses_frame ? `Go back to frame ${chosen}` : "Go back");
  by_id("go-back").disabled = !chooses_frame || chosen >= last;
  write(by_id("frame"), `Frame ${frame}`);
  write(by_id("time"), `${(frame / page.hello.fps).toFixed(2)} s`);
}

function listen_to_bar() {
  const on_click = (id, action) => by_id(id).addEventListener("click", action);
  on_click("pause", toggle_pause);
  on_click("step", () => order({ do: "step" }));
  on_click("slower", () => change_speed(0.5));
  on_click("faster", () => change_speed(2));
  on_click("restart", restart);
  on_click("pin", toggle_pin);
  on_click("keyboard-grab", toggle_crosshair);
  on_click("save", save);
  on_click("home", () => order({ do: "home" }));
  on_click("keep-view", keep_view);
  on_click("go-back", go_back);
  on_click("help", () => by_id("help-dialog").showModal());
  on_click("steer", try_to_steer);
  by_id("field").addEventListener("change", event => order({ do: "show", field: event.target.value }));
  order_by_box("wireframe", on => ({ do: "show", wireframe: on }));
  order_by_box("marks", on => ({ do: "show", marks: on }));
  order_by_box("keep-rate", on => ({ do: "keep_rate", on }));
  by_id("timeline").addEventListener("input", () => {
    chooses_frame = Number(by_id("timeline").value) < page.state.last;
    show_time();
  });
  document.addEventListener("pointerdown", event => {
    if (!by_id("view-menu").contains(event.target)) by_id("view-menu").open = false;
  });
}

function order_by_box(id, command) {
  by_id(id).addEventListener("change", async event => {
    if (!await order(command(event.target.checked))) show_state();
  });
}

async function keep_view() {
  if (!await order({ do: "keep_view" })) return;
  page.unsaved = true;
  remark("The film of the replay has this camera from this frame on.");
}

// ---- Controls: what a value looks like ----

const is_number_type = type => type === "number" || type === "whole number";

function text_of_toml(value) {
  const quoted = /^(["'])([^]*)\1$/.exec(value);
  if (!quoted) return value;
  if (quoted[1] === "'") return quoted[2];
  try {
    return JSON.parse(value);
  } catch (error) {
    return quoted[2];
  }
}

function three_numbers_of(value) {
  const numbers = value.match(/[-+]?(\d[\d_]*\.?\d*|\.\d+)(e[-+]?\d+)?/gi);
  return numbers && numbers.length === 3 && !value.includes("#") ? numbers : ["", "", ""];
}

function hex_colour_of(value) {
  const hex = /#[0-9a-f]{6}/i.exec(value);
  if (hex) return hex[0].toLowerCase();
  const byte = part => Math.round(255 * clamp(Number(part), 0, 1)).toString(16).padStart(2, "0");
  return "#" + three_numbers_of(value).map(byte).join("");
}

function is_same_value(a, b) {
  if (a === b || text_of_toml(a) === text_of_toml(b)) return true;
  if (!a.startsWith("[") || !b.startsWith("[")) return Number(a) === Number(b);
  const parts = three_numbers_of(b);
  return three_numbers_of(a).every((part, i) => part !== "" && Number(part) === Number(parts[i]));
}

// ---- Controls: sliders ----

const slider_steps = 1000;

// A slider's scale turns positions into values and back. Returns null where there is nothing to go by.
function scale_for({ type, unit, low, high, open_low }, value) {
  const bottom = low ?? -Infinity, top = high ?? Infinity, size = Math.max(1, Math.abs(value));
  if (!Number.isFinite(value)) return top - bottom <= 1000 ? linear_scale(bottom, top, open_low, false) : null;
  const whole = type === "whole number";
  if (bottom >= 0 && value > 0 && !whole && is_wide(bottom, top, open_low, value))
    return logarithmic_scale(Math.max(bottom, value / 100), Math.min(top, value * 100));
  if (bottom >= 0) {
    const reach = Math.max(10 * value, bottom + (whole ? 10 : 1));
    return linear_scale(bottom, Math.min(top, reach), open_low, whole);
  }
  if (top - bottom <= 1000 * size) return linear_scale(bottom, top, open_low, whole);
  const reach = unit.startsWith("degrees") ? 180 : type === "three numbers" ? 2 * size : 3 * size;
  return linear_scale(Math.max(bottom, value - reach), Math.min(top, value + reach), false, whole);
}

// Tells whether a range of positive numbers is too wide for equal steps.
function is_wide(bottom, top, open_low, value) {
  if (bottom === 0) return open_low && top > 20 * value;
  return top / bottom > 1000;
}

function logarithmic_scale(min, max) {
  const value_at = position => min * (max / min) ** (position / slider_steps);
  return {
    min: 0, max: slider_steps, holds: value => value >= min * 0.999 && value <= max * 1.001,
    value_at: position => short(value_at(position)),
    position_of: value => slider_steps * Math.log(value / min) / Math.log(max / min),
  };
}

function linear_scale(min, max, open_low, whole) {
  const holds = value => value >= min && value <= max;
  if (whole) return { min, max, holds, value_at: position => position, position_of: value => value };
  const lowest = open_low ? min + (max - min) / slider_steps : min;
  const digits = Math.max(0, 3 - Math.floor(Math.log10(max - min)));
  const value_at = position => min + (max - min) * position / slider_steps;
  return {
    min: 0, max: slider_steps, holds,
    value_at: position => clamp(Number(value_at(position).toFixed(digits)), lowest, max),
    position_of: value => slider_steps * (value - min) / (max - min),
  };
}

const short = value => Number(value.toPrecision(3));

// A slider and a field for one number. `put` gets the text of a value, and whether the slider is still being moved.
class NumberRow {
  constructor(control, label, put, { id, caption = "", reach = 0 } = {}) {
    const { spec } = control;
    this.spec = spec;
    this.reach = reach;
    this.scale = null;
    this.slider = make("input", { type: "range", name: label, "aria-label": `${label}, slider`, step: "1" });
    this.field = make("input", { type: "text", spellcheck: "false", autocomplete: "off", placeholder: "not set",
      name: label, class: "number", inputmode: spec.low >= 0 && spec.low !== null ? "decimal" : "text" });
    if (id) this.field.id = id;
    else this.field.setAttribute("aria-label", label);
    const mark = caption ? [make("span", { class: "axis", "aria-hidden": "true" }, caption)] : [];
    this.node = make("div", { class: "row" }, ...mark, this.slider, this.field);
    this.slider.addEventListener("input", () => this.slide(control, put));
    this.slider.addEventListener("change", () => control.release());
    listen_to_field(control, this.field, text => put(text));
  }

  slide(control, put) {
    control.hold();
    const text = String(this.scale.value_at(Number(this.slider.value)));
    this.field.value = text;
    this.slider.setAttribute("aria-valuetext", text);
    put(text);
  }

  // Shows a value; a slider that can't reach it gets a scale around it.
  show(text) {
    const value = text === "" ? NaN : Number(text);
    this.field.value = text;
    if (!this.scale || (Number.isFinite(value) && !this.scale.holds(value))) this.rescale(value);
    this.slider.hidden = !this.scale;
    this.slider.classList.toggle("unset", text === "");
    if (!this.scale) return;
    this.slider.value = Number.isFinite(value) ? this.scale.position_of(value) : this.scale.min;
    this.slider.setAttribute("aria-valuetext", text === "" ? "not set" : `${text} ${this.spec.unit}`.trim());
  }

  rescale(value) {
    this.scale = this.reach && Number.isFinite(value) ? linear_scale(-Math.max(this.reach, 2 * Math.abs(value)),
      Math.max(this.reach, 2 * Math.abs(value)), false, false) : scale_for(this.spec, value);
    if (!this.scale) return;
    this.slider.min = this.scale.min;
    this.slider.max = this.scale.max;
  }
}

// A text field sends when Enter is pressed or the focus leaves. An empty one sends nothing.
function listen_to_field(control, field, put) {
  field.addEventListener("input", () => control.hold());
  field.addEventListener("change", () => {
    if (field.value.trim() !== "") put(field.value.trim());
    control.release();
  });
  field.addEventListener("blur", () => control.leave());
  field.addEventListener("keydown", event => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    control.revert();
  });
}

// ---- Controls: an editor for each type ----

function number_editor(control) {
  return new NumberRow(control, control.spec.name, text => control.put(text), { id: control.id });
}

function three_numbers_editor(control) {
  const largest = Math.max(1, ...three_numbers_of(control.spec.value).map(part => Math.abs(Number(part))));
  const rows = ["x", "y", "z"].map(axis => new NumberRow(control, `${control.spec.name} ${axis}`, () => {
    const parts = rows.map(row => row.field.value.trim());
    if (parts.every(part => part !== "")) control.put(`[${parts.join(", ")}]`);
  }, { caption: axis, reach: 2 * largest }));
  return {
    node: make("div", { role: "group", "aria-labelledby": `${control.id}-name` }, ...rows.map(row => row.node)),
    show: text => three_numbers_of(text).forEach((part, i) => rows[i].show(part)),
  };
}

function colour_editor(control) {
  const field = make("input", { type: "color", id: control.id });
  const text = make("span", { class: "soft" });
  field.addEventListener("input", () => {
    control.hold();
    control.put(`"${field.value}"`);
    write(text, field.value);
  });
  field.addEventListener("change", () => control.release());
  return {
    node: make("div", { class: "row" }, field, text),
    show(value) {
      field.value = value === "" ? "#888888" : hex_colour_of(value);
      write(text, value === "" ? "not set" : field.value);
    },
  };
}

function word_editor(control) {
  const options = control.spec.words.map(word => make("option", { value: word }, word));
  const none = make("option", { value: "", disabled: "" }, "not set");
  const field = make("select", { id: control.id }, none, ...options);
  field.addEventListener("change", () => control.put(JSON.stringify(field.value)));
  return {
    node: make("div", { class: "row" }, field),
    show(value) {
      none.hidden = value !== "";
      field.value = text_of_toml(value);
    },
  };
}

function yes_or_no_editor(control) {
  const field = make("input", { type: "checkbox", id: control.id });
  field.addEventListener("change", () => control.put(String(field.checked)));
  const text = make("span", { class: "soft" });
  return {
    node: make("div", { class: "row" }, field, text),
    show(value) {
      field.checked = value === "true";
      field.indeterminate = value === "";
      write(text, value || "not set");
    },
  };
}

function text_editor(control) {
  const is_text = control.spec.type === "text";
  const field = make("input", { type: "text", id: control.id, spellcheck: "false", autocomplete: "off" });
  listen_to_field(control, field, text => control.put(is_text ? JSON.stringify(text) : text));
  return {
    node: make("div", { class: "row" }, field),
    show(value) {
      field.value = is_text ? text_of_toml(value) : value;
      field.placeholder = value === "" ? "not set" : "";
    },
  };
}

function editor_for(control) {
  const { type, unit } = control.spec;
  if (is_number_type(type)) return number_editor(control);
  if (type === "three numbers") return unit === "sRGB" ? colour_editor(control) : three_numbers_editor(control);
  if (type === "word") return word_editor(control);
  return type === "true or false" ? yes_or_no_editor(control) : text_editor(control);
}

// ---- Controls: one entry of the panel ----

class Control {
  constructor(spec, start, id) {
    Object.assign(this, { spec, start, id, in_force: spec.value, held: false, refused: false });
    this.lane = new Lane({
      taken: command => this.take(command.value),
      refused: refusal => this.refuse(refusal),
      settled: () => this.settle(),
    });
    this.editor = editor_for(this);
    this.fields = [...this.editor.node.querySelectorAll("input, select")];
    this.words = `${spec.path} ${spec.meaning} ${spec.unit}`.toLowerCase();
    this.build();
    this.show();
  }

  build() {
    const { spec, id } = this;
    const several = this.editor.node.getAttribute("role") === "group";
    const name = make(several ? "span" : "label", { id: `${id}-name`, class: "name", title: spec.path }, spec.name);
    if (!several) name.htmlFor = id;
    this.reset = make("button", { type: "button", class: "quiet reset", title: "Back to the value at the start",
      "aria-label": `Reset ${spec.name}` }, "reset");
    this.reset.addEventListener("click", () => this.put_back());
    const cost = spec.cost ? [make("span", { class: "tag", title: `A change asks for: ${spec.cost}` }, spec.cost)] : [];
    const limits = [spec.unit, is_number_type(spec.type) ? spec.allowed : ""].filter(Boolean).join(", ");
    const about = make("p", { id: `${id}-about`, class: "about soft" },
      make("span", { class: "meaning", title: spec.meaning }, spec.meaning), make("span", { class: "limits" }, limits));
    this.alert = make("p", { id: `${id}-alert`, class: "refusal", role: "alert" });
    for (const field of this.fields) field.setAttribute("aria-describedby", `${id}-about ${id}-alert`);
    this.node = make("div", { class: "control" }, make("div", { class: "head" }, name, ...cost, this.reset),
      about, this.editor.node, this.alert);
  }

  show() {
    this.editor.show(this.in_force === "none" ? "" : this.in_force);
    this.reset.hidden = this.start === "none" || is_same_value(this.start, this.in_force);
  }

  // While a control is held, what comes from elsewhere does not disturb it.
  hold() {
    this.held = true;
    this.clear_refusal();
  }

  release() {
    this.held = false;
    if (!this.lane.running) this.settle();
  }

  put(value) {
    this.clear_refusal();
    this.lane.send({ do: "set", path: this.spec.path, value });
  }

  put_back() {
    this.fields[0].focus();
    this.put(this.start);
  }

  take(value) {
    this.in_force = value;
    page.unsaved = true;
    this.reset.hidden = this.start === "none" || is_same_value(this.start, value);
  }

  refuse(refusal) {
    this.refused = true;
    this.alert.textContent = refusal.message;
    for (const field of this.fields) field.setAttribute("aria-invalid", "true");
  }

  clear_refusal() {
    if (!this.refused) return;
    this.refused = false;
    this.alert.textContent = "";
    for (const field of this.fields) field.removeAttribute("aria-invalid");
  }

  // A refused text stays in its field as long as it has the focus, so that it can be mended.
  settle() {
    const focus = document.activeElement;
    const mends = this.refused && this.fields.includes(focus) && focus.type === "text";
    if (!this.held && !this.lane.running && !mends) this.show();
  }

  leave() {
    this.held = false;
    this.clear_refusal();
    this.settle();
  }

  revert() {
    this.held = false;
    this.clear_refusal();
    this.show();
  }

  // A value that changed elsewhere.
  update(value) {
    this.in_force = value;
    this.reset.hidden = this.start === "none" || is_same_value(this.start, value);
    this.settle();
  }
}

// ---- The panel ----

const controls = new Map();      // by their path
const starts = new Map();        // values at the first hello, by path
const sections = new Map();      // <details> by group
let opened_for_search = null;    // which sections were open before the search

function rank_of_group(group) {
  const bodies = page.hello.bodies.map(body => body.name);
  if (bodies.includes(group)) return bodies.indexOf(group);
  const rank = ["scene", "solver", "", "camera", "look"].indexOf(group);
  return bodies.length + (rank === -1 ? 2 : rank);
}

// Materials come first.
function rank_of_control(spec) {
  return spec.name.includes("material") ? 0 : 1;
}

function build_panel(specs) {
  const was_open = new Map([...sections].map(([group, section]) => [group, section.open]));
  const focus = document.activeElement && document.activeElement.id;
  controls.clear();
  sections.clear();
  by_id("panel").querySelectorAll("details").forEach(section => section.remove());
  const groups = [...new Set(specs.map(spec => spec.group))].sort((a, b) => rank_of_group(a) - rank_of_group(b));
  for (const group of groups) {
    const members = specs.filter(spec => spec.group === group).sort((a, b) => rank_of_control(a) - rank_of_control(b));
    build_section(group, members, was_open.get(group));
  }
  opened_for_search = null;
  search_controls();
  if (focus && document.activeElement.id !== focus && by_id(focus)) by_id(focus).focus();
}

// Different paths have different ids, which have no characters that selectors read in their own way.
const id_of_control = path => "control-" + path.replace(/[^A-Za-z0-9-]/g, sign => `_${sign.codePointAt(0).toString(16)}_`);

function build_section(group, specs, was_open) {
  const body = page.hello.bodies.find(each => each.name === group);
  const about = body ? `${body.vertices} vertices, ${body.elements} elements` : "";
  const section = make("details", { class: "section" },
    make("summary", {}, make("h3", {}, group), make("span", { class: "soft" }, about)));
  section.open = was_open ?? !(group === "camera" || group === "look");
  for (const spec of specs) {
    if (!starts.has(spec.path)) starts.set(spec.path, spec.value);
    const control = new Control(spec, starts.get(spec.path), id_of_control(spec.path));
    controls.set(spec.path, control);
    section.append(control.node);
  }
  sections.set(group, section);
  by_id("panel").append(section);
}

function search_controls() {
  const wanted = by_id("search").value.toLowerCase().split(/\s+/).filter(Boolean);
  let found = 0;
  for (const control of controls.values()) {
    const fits = wanted.every(word => control.words.includes(word));
    control.node.hidden = !fits;
    found += fits;
  }
  open_sections_with_hits(wanted.length > 0);
  const some = wanted.length > 0 ? `${found} of ${controls.size}` : `${found}`;
  write(by_id("found"), found === 0 ? "nothing found" : some);
}

function open_sections_with_hits(searches) {
  if (searches && !opened_for_search)
    opened_for_search = new Map([...sections.values()].map(section => [section, section.open]));
  for (const section of sections.values()) {
    const has_hits = section.querySelector(".control:not([hidden])") !== null;
    section.hidden = !has_hits;
    if (searches) section.open = has_hits;
    else if (opened_for_search) section.open = opened_for_search.get(section);
  }
  if (!searches) opened_for_search = null;
}

// ---- What the program says ----

function show_state() {
  const { state } = page;
  document.body.classList.toggle("paused", state.paused);
  write(by_id("pause-text"), state.paused ? "Run" : "Pause");
  write(by_id("speed"), `${short_number(state.speed)} ×`);
  by_id("field").value = state.field;
  by_id("wireframe").checked = state.wireframe;
  by_id("marks").checked = state.marks;
  by_id("keep-rate").checked = state.keeps_rate;
  show_time();
  show_pins();
  show_pace();
  show_role();
}

function show_pins() {
  const list = by_id("pins"), names = page.state.pins.map(pin => `${pin.body} ${pin.name}`);
  if (list.dataset.names === names.join()) return;
  list.dataset.names = names.join();
  list.replaceChildren(...page.state.pins.map((pin, i) => {
    const button = make("button", { type: "button", "aria-label": `Let go of ${names[i]}` }, "Let go");
    button.addEventListener("click", () => order({ do: "release", body: pin.body, name: pin.name }));
    return make("li", {}, `Pin on ${pin.body} (${pin.name}) `, button);
  }));
}

// The film's speed, smoothed over a few frames and in words.
function show_pace() {
  const { paused, speed, keeps_rate } = page.state;
  const recent = page.history.slice(-15);
  const rate = recent.reduce((sum, frame) => sum + frame.rate, 0) / recent.length;
  const asked = speed === 1 ? "Real time" : `${short_number(speed)} of real time, as asked`;
  const wanted = speed === 1 ? "" : `, ${short_number(speed)} was asked for`;
  const slow = `${short_number(rate * speed, 2)} of real time${wanted}: ` +
    (keeps_rate ? "steps that end early take too long, too" : "every frame is simulated");
  write(by_id("pace"), paused ? "Paused" : recent.length === 0 || rate >= 0.95 ? asked : slow);
}

function show_role() {
  const alone = page.hello && !page.hello.steered;
  const text = page.watches ? "You are watching." : alone ? "Nobody steers now. You are watching."
    : "Somebody else steers. You are watching.";
  by_id("watching").hidden = steers() || !page.hello;
  by_id("steer").hidden = page.watches;
  by_id("hint").hidden = !steers();
  write(by_id("watching-text"), text);
  for (const id of ["bar", "time-travel", "panel"]) by_id(id).disabled = !steers();
  by_id("pins").hidden = !steers() || page.state.pins.length === 0;
}

function show_words(words) {
  const box = by_id("words"), key = words.join("\n");
  if (box.dataset.words === key) return;
  box.dataset.words = key;
  box.classList.toggle("warning", words.length > 0);
  box.replaceChildren(words.length === 0 ? make("p", { class: "soft" }, "Nothing is wrong.")
    : make("ul", {}, ...words.map(word => make("li", {}, word))));
}

function take_hello(hello) {
  const knows_all = page.hello && page.hello.scene === hello.scene;
  page.hello = hello;
  page.state = hello.state;
  page.ended = hello.end ? hello.end.text : "";
  if (!knows_all && hello.state.last - hello.state.first > 5 * hello.fps) page.unsaved = true;  // by an earlier page
  write(by_id("title"), hello.title);
  document.title = `${hello.title} – supple live`;
  by_id("stage").style.setProperty("--ratio", hello.width / hello.height);
  by_id("field").replaceChildren(...hello.fields.map(field =>
    make("option", { value: field }, field === "none" ? "materials" : field)));
  build_panel(hello.controls);
  show_words(hello.words);
  show_connection();
  show_state();
}

function take_frame(frame) {
  if (!page.state) return;
  page.state.frame = frame.frame;
  page.state.last = Math.max(page.state.last, frame.frame);
  const kept = page.history.filter(each => each.frame < frame.frame);
  page.history = [...kept, frame].slice(-graph_frames);
  show_time();
  draw_soon();
}

function take_state(state) {
  page.state = state;
  if (Number(by_id("timeline").value) >= state.last) chooses_frame = false;
  page.history = page.history.filter(each => each.frame <= state.frame);
  draw_soon();
  show_state();
}

const events = {
  hello: take_hello,
  controls: build_panel,
  value: ({ path, value }) => controls.has(path) && controls.get(path).update(value),
  state: take_state,
  frame: take_frame,
  words: show_words,
  say: ({ text }) => remark(text),
  steered(is_steered) {
    page.hello.steered = is_steered;
    show_role();
  },
  moved() {  // another page has the claim of this one, of which it is a copy
    page.wants_to_steer = false;
    lose_claim();
  },
  end({ text }) {
    page.ended = text;
    show_connection();
  },
};

// ---- The connection ----

let lost = false;
let wake = () => {};        // ends the pause before the next attempt to get a picture
let end_events = () => {};  // ends the events' connection

function show_connection() {
  const ended = page.ended && `The simulation has ended: ${page.ended}`;
  const text = ended || !lost ? ended : `${unreachable} Trying again …`;
  write(by_id("connection"), text);
  by_id("connection").classList.toggle("warning", text !== "");
}

function lose_claim() {
  keep_writer(null);
  end_events("again");
}

function keep_writer(writer) {
  page.writer = writer;
  if (writer) sessionStorage.setItem(claim_key, writer);
  else sessionStorage.removeItem(claim_key);
}

function try_to_steer() {
  page.wants_to_steer = true;
  lose_claim();
}

// Gets the right to steer, unless this page only watches. Throws when the program cannot be reached.
async function claim() {
  if (page.watches || !page.wants_to_steer || page.writer) return;
  const answer = await fetch("./claim", { method: "POST" });
  if (answer.ok) return keep_writer((await answer.json()).writer);
  if (answer.status !== 409) throw new Refusal(answer.status, await error_text(answer));
  page.wants_to_steer = false;
  if (!page.hello || page.hello.steered) return;
  remark("The page that steered may come back for some seconds; then this one steers.");
  setTimeout(try_to_steer, 1500);
}

// Follows the events until the connection ends. Returns "lost" when it stood, "unreachable" when it never did, and
// "again" when a new claim is needed.
function follow_events() {
  const steering = page.writer ? `?writer=${encodeURIComponent(page.writer)}` : "";
  const source = new EventSource(`./events${steering}`);
  let opened = false;
  for (const [name, take] of Object.entries(events))
    source.addEventListener(name, event => take(JSON.parse(event.data)));
  source.addEventListener("open", () => {
    opened = true;
    lost = false;
    show_connection();
    wake();
  });
  return new Promise(resolve => {
    end_events = how => {
      source.close();
      resolve(how);
    };
    source.addEventListener("error", () => {
      if (opened || source.readyState !== EventSource.CLOSED) return end_events(opened ? "lost" : "unreachable");
      if (page.writer) lose_claim();  // the program knows no such claim
      else end_events("unreachable");
    });
  });
}

async function stay_connected() {
  for (let pause = shortest_pause_ms; ;) {
    const end = await claim().then(follow_events).catch(() => "unreachable");
    if (end === "again") {
      await sleep(busy_pause_ms);
      continue;
    }
    lost = true;
    show_connection();
    pause = end === "lost" ? shortest_pause_ms : Math.min(longest_pause_ms, 2 * pause);
    await sleep(pause);
  }
}

// ---- The picture ----

async function visible() {
  while (document.hidden)
    await new Promise(resolve => document.addEventListener("visibilitychange", resolve, { once: true }));
}

function note_touch(input) {
  if (!page.touch || input < page.touch.input) return;
  page.touch_ms = performance.now() - page.touch.at;
  page.touch = null;
}

async function draw_picture(answer) {
  const bitmap = await createImageBitmap(await answer.blob());
  if (picture.width !== bitmap.width || picture.height !== bitmap.height) {
    picture.width = bitmap.width;
    picture.height = bitmap.height;
    by_id("stage").style.setProperty("--ratio", bitmap.width / bitmap.height);
  }
  picture.getContext("2d").drawImage(bitmap, 0, 0);
  bitmap.close();
  note_touch(Number(answer.headers.get("X-Input")));
}

async function show_pictures() {
  let shown = 0;
  for (let pause = shortest_pause_ms; ;) {
    await visible();
    try {
      const answer = await fetch(`./picture?after=${shown}`);
      if (!answer.ok) throw new Refusal(answer.status, "no picture");
      if (answer.status === 200) {
        shown = Number(answer.headers.get("X-Picture"));
        await draw_picture(answer);
      }
      pause = shortest_pause_ms;
    } catch (error) {
      shown = 0;
      await Promise.race([sleep(pause), new Promise(resolve => { wake = resolve; })]);
      pause = Math.min(longest_pause_ms, 2 * pause);
    }
  }
}

// ---- Graphs ----

let drawing = false, numbers_at = 0, labels_at = 0;

function draw_soon() {
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(now => {
    drawing = false;
    if (!page.hello) return;
    draw_cost();
    draw_error();
    if (now - numbers_at > 250) show_numbers(now);
    if (now - labels_at > 1000) label_graphs(now);
  });
}

function graph_colours() {
  const style = getComputedStyle(document.documentElement);
  const colour = name => style.getPropertyValue(`--${name}`).trim();
  return Object.fromEntries(["soft", "line", "plain", "warn"].map(name => [name, colour(name)]));
}

// Makes a canvas as fine as the screen and clears it. Returns what is needed to draw on it in CSS pixels.
function prepare(canvas) {
  const width = canvas.clientWidth, height = canvas.clientHeight, fine = window.devicePixelRatio || 1;
  const columns = Math.round(width * fine), rows = Math.round(height * fine);
  if (canvas.width !== columns || canvas.height !== rows) Object.assign(canvas, { width: columns, height: rows });
  const pen = canvas.getContext("2d");
  pen.setTransform(fine, 0, 0, fine, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  pen.textBaseline = "middle";
  pen.lineJoin = "round";
  const left = 44, right = width - 6, top = 28, bottom = height - 8;  // above is room for the key
  const x_of = i => right - (page.history.length - 1 - i) * (right - left) / (graph_frames - 1);
  return { pen, left, right, top, bottom, x_of, colours: graph_colours() };
}

function draw_tick({ pen, left, right, colours }, y, text) {
  pen.strokeStyle = colours.line;
  pen.lineWidth = 1;
  pen.beginPath();
  pen.moveTo(left, Math.round(y) + 0.5);
  pen.lineTo(right, Math.round(y) + 0.5);
  pen.stroke();
  pen.fillStyle = colours.soft;
  pen.textAlign = "right";
  pen.fillText(text, left - 6, y);
}

// Draws a line through the frames' values; null leaves a gap.
function draw_line({ pen, x_of }, values, y_of, colour) {
  pen.strokeStyle = colour;
  pen.lineWidth = 1.6;
  pen.beginPath();
  let draws = false;
  values.forEach((value, i) => {
    if (value === null) draws = false;
    else if (draws) pen.lineTo(x_of(i), y_of(value));
    else {
      pen.moveTo(x_of(i), y_of(value));
      draws = true;
    }
  });
  pen.stroke();
}

const frame_ms = () => 1000 / page.hello.fps;

function draw_cost() {
  const graph = prepare(by_id("cost")), { pen, left, right, top, bottom, colours } = graph;
  const values = page.history.map(frame => frame.ms), limit = frame_ms();
  const highest = Math.max(1.5 * limit, ...values) * 1.05;
  const y_of = ms => bottom - (bottom - top) * ms / highest;
  draw_tick(graph, y_of(0), "0");
  draw_tick(graph, y_of(limit), short_number(limit));
  if (highest > 2.2 * limit) draw_tick(graph, top + 6, short_number(highest, 2));
  for (const [from, to, colour] of [[y_of(limit), bottom + 1, colours.plain], [0, y_of(limit), colours.warn]]) {
    pen.save();
    pen.beginPath();
    pen.rect(left, from, right - left + 2, to - from);
    pen.clip();
    draw_line(graph, values, y_of, colour);
    pen.restore();
  }
  draw_limit(graph, y_of(limit));
}

function draw_limit(graph, y) {
  draw_dashes(graph, graph.left, graph.right, y);
  draw_dashes(graph, graph.left, graph.left + 22, key_y);
  draw_key(graph, graph.left + 28, `${short_number(frame_ms())} ms: the time that a frame lasts`);
}

function draw_dashes({ pen, colours }, from, to, y) {
  pen.strokeStyle = colours.soft;
  pen.lineWidth = 1.4;
  pen.setLineDash([4, 4]);
  pen.beginPath();
  pen.moveTo(from, y);
  pen.lineTo(to, y);
  pen.stroke();
  pen.setLineDash([]);
}

const key_y = 9;

function draw_key({ pen, colours }, x, text) {
  pen.textAlign = "left";
  pen.fillStyle = colours.soft;
  pen.fillText(text, x, key_y);
}

function draw_error() {
  const graph = prepare(by_id("error")), { x_of, left, top, bottom, colours } = graph;
  const values = page.history.map(frame => frame.error > 0 ? Math.log10(frame.error) : null);
  const known = values.filter(value => value !== null);
  if (known.length === 0) return;
  const high = Math.ceil(Math.max(...known) + 0.01), low = Math.min(high - 2, Math.floor(Math.min(...known)));
  const y_of = power => bottom - (bottom - top) * (power - low) / (high - low);
  const stride = Math.ceil((high - low) / 5);
  for (let power = low; power <= high; power += stride) draw_tick(graph, y_of(power), power_of_ten(power));
  draw_line(graph, values, y_of, colours.plain);
  page.history.forEach((frame, i) => {
    if (frame.unsolved) draw_dot(graph, x_of(i), y_of(values[i] ?? high));
  });
  draw_dot(graph, left + 4, key_y);
  draw_key(graph, left + 12, `${unsolved_frames()} of ${page.history.length} frames not solved`);
}

function draw_dot({ pen, colours }, x, y) {
  pen.fillStyle = colours.warn;
  pen.beginPath();
  pen.arc(x, y, 2.5, 0, 2 * Math.PI);
  pen.fill();
}

const unsolved_frames = () => page.history.filter(frame => frame.unsolved).length;

function power_of_ten(power) {
  const digits = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  return "10" + String(power).replace(/./g, sign => sign === "-" ? "⁻" : digits[sign]);
}

function show_numbers(now) {
  numbers_at = now;
  const frame = page.history[page.history.length - 1];
  if (!frame) return;
  write(by_id("cost-text"), cost_words(frame));
  write(by_id("error-text"), error_words(frame));
  by_id("cost-text").classList.toggle("over", frame.ms > frame_ms());
  by_id("error-text").classList.toggle("over", frame.unsolved);
  show_pace();
}

function cost_words(frame) {
  const ms = value => `${value.toFixed(1)} ms`;
  const changes = frame.change_ms > 0 ? `, changes ${ms(frame.change_ms)}` : "";
  const touch = page.touch_ms === null ? "" : `; from hand to picture ${Math.round(page.touch_ms)} ms`;
  return `steps ${ms(frame.ms)} of ${ms(frame_ms())}${changes}, drawing ${ms(frame.draw_ms)}${touch}`;
}

function error_words(frame) {
  const error = frame.error === null ? "unknown" : short_number(frame.error, 2);
  const missing = frame.motion > 0 ? `, ${short_number(100 * frame.motion, 2)} % of the motion missing` : "";
  return `${error}, ${frame.iterations} iterations${missing}${frame.unsolved ? "; not solved" : ""}`;
}

function label_graphs(now) {
  labels_at = now;
  const frames = page.history.length, over = page.history.filter(frame => frame.ms > frame_ms()).length;
  by_id("cost").setAttribute("aria-label", `Time of a frame's steps: ${by_id("cost-text").textContent}. ` +
    `${over} of the last ${frames} frames took longer than they last.`);
  by_id("error").setAttribute("aria-label", `Error estimate, logarithmic: ${by_id("error-text").textContent}. ` +
    `${unsolved_frames()} of the last ${frames} frames were not solved.`);
}

// ---- Start ----

function start() {
  listen_to_picture();
  listen_to_bar();
  document.addEventListener("keydown", press_key);
  by_id("search").addEventListener("input", search_controls);
  new ResizeObserver(draw_soon).observe(by_id("cost"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw_soon);
  stay_connected();
  show_pictures();
}

start();
