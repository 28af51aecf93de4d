// Messages that run along the arrows. Each dot is one that has crossed, as the lab's recorder has told; no timer makes
// any. What crosses more often than an eye can follow is a number at its arrow instead, and whoever has asked for
// reduced motion sees the arrow light up and no dot move.

const SVG = "http://www.w3.org/2000/svg";
const HOP = 550; // milliseconds that a dot takes for one arrow
const FOLLOWED = 8; // messages a second; more on one arrow are told as a rate
const SECOND = 1000;

function shape(tag, attributes, ...children) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

function traffic(picture) {
  const reduced = window.matchMedia("(prefers-reduced-motion: reduce)");
  const recent = new Map(); // by arrow and direction: how many, and when, in the last two seconds
  const ends = new Map(); // by channel: when the dots of each stage will have arrived
  const calming = new Map();

  function find({ node, verb, channel }) {
    const [of, on, what] = [node, channel, verb].map((one) => CSS.escape(one));
    return picture.querySelector(`.ck-use[data-of="${of}"][data-on="${on}"][data-verb="${what}"]`);
  }

  // A page or a kernel that was busy shows many messages at once: only what comes in two seconds running is a rate.
  function ratePerSecond(key, count) {
    const now = performance.now();
    const kept = (recent.get(key) ?? []).filter(([at]) => now - at < 2 * SECOND);
    kept.push([now, count]);
    recent.set(key, kept);
    const seconds = [0, 0];
    for (const [at, many] of kept) seconds[Math.floor((now - at) / SECOND)] += many;
    return Math.min(...seconds) > FOLLOWED ? Math.round((seconds[0] + seconds[1]) / 2) : 0;
  }

  // A response sets out when the request has arrived, though both may have crossed within a millisecond.
  function start(channel, stage) {
    const known = ends.get(channel) ?? [0, 0, 0, 0];
    ends.set(channel, known);
    const begin = Math.max(performance.now(), ...known.slice(0, stage));
    known[stage] = begin + HOP;
    return begin;
  }

  function showRate(use, key, rate) {
    use.classList.add("ck-busy");
    let label = use.querySelector("text");
    if (!label) {
      label = shape("text", { class: "ck-rate", "text-anchor": "middle" });
      use.append(label);
    }
    const line = use.querySelector(".ck-line");
    const middle = line.getPointAtLength(line.getTotalLength() / 2);
    label.setAttribute("x", middle.x);
    label.setAttribute("y", middle.y - 6);
    label.textContent = `${rate}/s`;
    clearTimeout(calming.get(key));
    calming.set(key, setTimeout(() => {
      label.remove();
      use.classList.remove("ck-busy");
    }, 1.5 * SECOND));
  }

  function lightUp(use, key) {
    use.classList.add("ck-crossed");
    clearTimeout(calming.get(key));
    calming.set(key, setTimeout(() => use.classList.remove("ck-crossed"), SECOND));
  }

  function run(use, hop) {
    const line = use.querySelector(".ck-line");
    const length = line.getTotalLength();
    const back = hop.leaves === (hop.verb === "serves" || hop.verb === "runs the action" || hop.verb === "listens to");
    const begin = start(`${hop.kind} ${hop.channel}`, hop.stage);
    const dot = shape("circle", { r: 5.5, class: `ck-dot ck-${hop.kind}`, "data-of": hop.node, "data-on": hop.channel,
      "data-way": hop.leaves ? "out" : "in" });
    const step = (now) => {
      const share = (now - begin) / HOP;
      if (share >= 1 || !use.isConnected) {
        dot.remove();
        return;
      }
      if (share >= 0) {
        const { x, y } = line.getPointAtLength(length * (back ? 1 - share : share));
        dot.setAttribute("transform", `translate(${x} ${y})`);
        if (!dot.isConnected) use.append(dot);
      }
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  return (hops) => {
    for (const hop of hops) {
      const use = find(hop);
      if (!use) continue; // filtered away, or not discovered yet
      const key = `${hop.node} ${hop.verb} ${hop.channel} ${hop.leaves} ${hop.stage}`;
      const rate = ratePerSecond(key, hop.count);
      if (rate) showRate(use, key, rate);
      else if (reduced.matches) lightUp(use, key);
      else run(use, hop);
    }
  };
}
