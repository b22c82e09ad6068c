// The numbers of the page: what report_data.py packed, as typed arrays, and how to look something up in them.
(function (page) {
  "use strict";

  function unpacked(text, kind) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return kind === "f8" ? new Float64Array(bytes.buffer) : new Float32Array(bytes.buffer);
  }

  // Replaces every {type, data} by its numbers. Little-endian, as all machines with browsers are.
  function unpack(value) {
    if (value === null || typeof value !== "object") return value;
    if (typeof value.data === "string" && typeof value.type === "string") return unpacked(value.data, value.type);
    for (const key of Object.keys(value)) value[key] = unpack(value[key]);
    return value;
  }

  // Where t lies in rising times: {at, next, share}, so that the value is (1 - share) x[at] + share x[next].
  page.place = function (times, t) {
    let low = 0, high = times.length - 1;
    if (!(t > times[0])) return {at: 0, next: 0, share: 0};
    if (t >= times[high]) return {at: high, next: high, share: 0};
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle; else high = middle;
    }
    return {at: low, next: high, share: (t - times[low]) / (times[high] - times[low])};
  };

  // The row nearest to t.
  page.nearest = function (times, t) {
    const {at, next, share} = page.place(times, t);
    return share < 0.5 ? at : next;
  };

  page.colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

  // A number in about `digits` figures, without a needless exponent; blank where there is none.
  page.number = function (value, digits = 4) {
    if (value === null || !isFinite(value)) return "–";
    const size = Math.abs(value);
    return value === 0 ? "0" : size >= 1e5 || size < 1e-3 ? value.toExponential(digits - 2) : value.toPrecision(digits);
  };

  unpack(page.data);
  for (const plot of page.data.plots) {  // one array for each line
    const rows = plot.x.length;
    plot.lines = plot.names.map((_, i) => plot.y.subarray(i * rows, (i + 1) * rows));
  }
})(window.osculate);
