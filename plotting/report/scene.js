// The arm in space: frames from the data, bodies from shapes.js, drawn by WebGL or, where that is missing, as SVG.
(function (page) {
  "use strict";
  const data = page.data.motion;
  const box = document.getElementById("canvas");

  // A WebGL context, or null. Asked for here: three.js would report a failure as an error.
  function context(canvas) {
    const options = {alpha: true, antialias: true, powerPreference: "low-power"};
    return canvas.getContext("webgl2", options) || canvas.getContext("webgl", options);
  }

  function makeRenderer() {
    if (location.hash !== "#svg") {
      const canvas = document.createElement("canvas"), gl = context(canvas);
      if (gl) {
        const renderer = new THREE.WebGLRenderer({canvas: canvas, context: gl, alpha: true, antialias: true});
        renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
        renderer.setClearColor(0, 0);
        return renderer;
      }
    }
    const renderer = new THREE.SVGRenderer();
    renderer.setClearColor(new THREE.Color(page.colour("view")), 1);
    renderer.setPrecision(1);
    return renderer;
  }

  function make() {
    const renderer = makeRenderer(), webgl = renderer instanceof THREE.WebGLRenderer;
    const shapes = page.shapes(webgl), scene = new THREE.Scene();
    const camera = new THREE.PerspectiveCamera(32, 1, 0.001, 1000);
    camera.up.set(0, 0, 1);
    const layers = {}, lines = [];
    const view = {webgl: webgl, layers: layers, tip: new THREE.Vector3()};
    const vector = (array, at = 0) => new THREE.Vector3(array[at], array[at + 1], array[at + 2]);

    const low = vector(data.low), high = vector(data.high);
    const middle = low.clone().add(high).multiplyScalar(0.5);
    const size = Math.max(high.distanceTo(low), 0.3 * data.length, 1e-3);
    const thick = Math.min(0.024 * Math.min(data.length, 1.5 * size), 0.3 * data.rod);

    // One layer for each thing that can be switched off.
    function layer(name, text, colour, shown) {
      const group = new THREE.Group();
      group.visible = shown;
      layers[name] = {group: group, text: text, colour: colour};
      scene.add(group);
      return group;
    }
    function line(...words) {
      const made = shapes.line(...words);
      lines.push(made);
      return made;
    }

    scene.add(new THREE.AmbientLight("#ffffff", webgl ? 0.62 : 0.5));
    for (const [x, y, z, strength] of [[2, -1.4, 3, 0.5], [-2, 1, 0.5, 0.2]]) {
      const light = new THREE.DirectionalLight("#ffffff", strength);
      light.position.set(x, y, z);
      scene.add(light);
    }

    addFloor();
    const frames = addArm();
    const tipMark = shapes.ball(0.9 * thick, shapes.material(page.colour("series-0")));
    scene.add(tipMark);
    const path = addPath();
    addReference();
    const surroundings = data.surface || data.obstacles.length ? layer("surface", data.surface ? "surface" : "obstacles", page.colour("series-7"), true) : null;
    if (surroundings) addSurroundings(surroundings);
    const arrow = data.force ? addForce() : null;
    const ellipsoids = [["effective_mass", "effective mass", "series-2", true], ["effective_inertia", "effective inertia", "series-3", false]]
      .filter(([name]) => data[name]).map((words) => ({text: words[1], show: addEllipsoid(...words)}));

    function addFloor() {
      const floor = layer("floor", "floor and axes", page.colour("line"), true);
      const step = Math.pow(10, Math.floor(Math.log10(size / 3)));
      const cell = [5, 2, 1].map((factor) => factor * step).find((width) => size / width >= 3) || step;
      const half = Math.ceil(0.75 * size / cell), z = Math.min(low.z, 0);
      const points = [];
      const x = Math.round(middle.x / cell) * cell, y = Math.round(middle.y / cell) * cell;
      for (let i = -half; i <= half; i++)
        points.push(x + i * cell, y - half * cell, z, x + i * cell, y + half * cell, z, x - half * cell, y + i * cell, z, x + half * cell, y + i * cell, z);
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
      floor.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({color: new THREE.Color(page.colour("line"))})));
      const triad = shapes.triad(0.2 * size);
      triad.children.forEach((axis) => lines.push(axis));
      floor.add(triad);
      view.cell = cell;
    }

    function addArm() {
      const axes = layer("axes", "joint axes", page.colour("series-5"), false);
      const grey = shapes.material(page.colour("arm")), hub = shapes.material(page.colour("series-5")), slide = shapes.material(page.colour("series-4"));
      const count = data.links.length, moving = data.links.filter((link) => link.type !== "fixed").length;
      let joint = 0;
      const radius = () => thick * (1 - 0.5 * Math.min(1, joint / Math.max(1, moving)));
      return data.links.map((link, i) => {
        const group = new THREE.Group(), frame = {group: group, axis: null, rail: null};
        scene.add(group);
        if (link.type !== "fixed") joint += 1;
        const axis = vector(link.axis), r = radius();
        if (i === 0) group.add(shapes.drum(new THREE.Vector3(0, 0, 1), 2.2 * thick, 0.8 * thick, grey));
        else if (link.type === "prismatic") {
          group.add(shapes.bar(axis, 2.3 * r, 3 * r, slide));
          frame.rail = shapes.rod(new THREE.Vector3(), axis.clone().negate(), 0.55 * r, 0.55 * r, slide);
          frame.rail.userData.axis = axis;
          group.add(frame.rail);
        } else if (link.type === "planar") group.add(shapes.drum(axis, 4 * thick, 1.2 * thick, slide));
        else if (link.type === "floating") group.add(shapes.box(5 * thick, 5 * thick, 5 * thick, slide));
        else if (link.type !== "fixed") group.add(shapes.drum(axis, 1.3 * r, 3 * r, hub));
        if (link.type !== "fixed" && link.type !== "floating" && i > 0) {
          const reach = axis.clone().multiplyScalar(4 * thick + 2 * r);
          frame.axis = new THREE.Group();
          const mark = line([...reach.clone().negate().toArray(), ...reach.toArray()], page.colour("series-5"), 1.5);
          frame.axis.add(mark);
          axes.add(frame.axis);
        }
        const next = i + 1 < count ? data.links[i + 1] : null;
        if (next && link.visuals.length === 0 && next.type !== "planar" && next.type !== "floating") {
          const end = vector(next.position);
          if (end.length() > 1e-6) group.add(shapes.rod(new THREE.Vector3(), end, 0.85 * r, 0.7 * r, grey));
        }
        for (const visual of link.visuals) group.add(shapes.visual(visual, grey));
        return frame;
      });
    }

    function addPath() {
      const group = layer("path", "path of the tip", page.colour("series-0"), true);
      const points = Array.from(data.tip);
      if (points.length < 6) return null;
      const colour = page.colour("series-0"), past = line(points, colour, 3, 1, 3);
      group.add(line(points, colour, webgl ? 1.2 : 1.6, webgl ? 0.55 : 1, 2), past);
      past.visible = webgl;
      return past;
    }

    function addReference() {
      const reference = data.reference, points = [];
      for (let i = 0; i < reference.length; i += 3) if (isFinite(reference[i])) points.push(reference[i], reference[i + 1], reference[i + 2]);
      if (points.length < 6) return;
      const group = layer("reference", "reference", page.colour("series-4"), true);
      group.add(line(points, page.colour("series-4"), webgl ? 6 : 3, webgl ? 0.6 : 1, 1));
      view.target = shapes.ball(1.25 * thick, shapes.material(page.colour("series-4"), 0.4));
      group.add(view.target);
    }

    function addSurroundings(group) {
      const grey = shapes.material(page.colour("series-7"), 0.35);
      const balls = data.obstacles.concat(data.surface && data.surface.type === "ball" ? [data.surface] : []);
      for (const ball of balls) {
        const body = shapes.ball(ball.radius, grey);
        body.position.fromArray(ball.centre);
        group.add(body);
      }
      if (data.surface && data.surface.type === "plane") {
        const normal = vector(data.surface.normal).normalize(), point = vector(data.surface.point);
        const tips = new THREE.Box3().setFromArray(data.tip), centre = tips.getCenter(new THREE.Vector3());
        centre.addScaledVector(normal, normal.dot(point.clone().sub(centre)));  // below the tip's path
        const sheet = shapes.drum(normal, Math.max(0.18 * size, 0.75 * tips.getSize(new THREE.Vector3()).length()), 0.002 * size, grey);
        sheet.position.copy(centre).addScaledVector(normal, -0.001 * size);
        group.add(sheet);
      }
    }

    function addForce() {
      const group = layer("force", "force on the tip", page.colour("series-1"), true);
      const arrow = shapes.arrow(0.45 * thick, page.colour("series-1"));
      group.add(arrow);
      let most = 0;
      for (let i = 0; i < data.force.length; i += 3) most = Math.max(most, vector(data.force, i).length());
      view.forceScale = 0.3 * size / most;
      return arrow;
    }

    function addEllipsoid(name, text, colour, shown) {
      const group = layer(name, text, page.colour(colour), shown), numbers = data[name];
      const body = shapes.ball(1, shapes.material(page.colour(colour), 0.34));
      body.matrixAutoUpdate = false;
      group.add(body);
      const scale = 0.15 * size / numbers.typical, longest = 0.5 * size;
      view.scales = (view.scales || []).concat([{name: name, text: text, unit: numbers.unit, perMetre: 1 / scale}]);
      // Draws it at an instant. Returns what the reader must know, "" if nothing.
      return function (at) {
        if (!group.visible) return "";
        const half = [0, 1, 2].map((i) => numbers.values[3 * at + i] * scale);
        const known = half.filter(isFinite).length;
        const most = Math.max(...half.filter(isFinite));
        body.visible = known >= 2 && most <= longest;
        if (!body.visible) return known < 2 ? "does not exist" : "is too large to draw";
        const directions = [0, 1, 2].map((i) => vector(numbers.axes, 9 * at + 3 * i));
        if (directions[0].clone().cross(directions[1]).dot(directions[2]) < 0) directions[2].negate();
        const basis = new THREE.Matrix4().makeBasis(...directions);
        body.matrix.copy(basis).scale(new THREE.Vector3(...half.map((length) => isFinite(length) ? Math.max(length, 1e-5 * size) : 1e-3 * size)));
        body.matrix.setPosition(view.tip);
        body.matrixWorldNeedsUpdate = true;
        return known < 3 ? "is infinite across the disc" : "";
      };
    }

    // Between two instants: straight for positions, along the shortest turn for rotations.
    const between = (array, {at, next, share}, width, i) =>
      vector(array, width * at + 3 * i).lerp(vector(array, width * next + 3 * i), share);

    view.show = function (time) {
      const where = page.place(data.time, time), {at, next, share} = where, count = frames.length;
      frames.forEach((frame, i) => {
        const group = frame.group;
        group.position.copy(between(data.positions, where, 3 * count, i));
        group.quaternion.copy(shapes.quaternion(data.rotations, 4 * (count * at + i)))
          .slerp(shapes.quaternion(data.rotations, 4 * (count * next + i)), share);
        if (frame.axis) {
          frame.axis.position.copy(group.position);
          frame.axis.quaternion.copy(group.quaternion);
        }
        if (frame.rail) {
          const slide = data.links[i].slide[at] * (1 - share) + data.links[i].slide[next] * share, rail = frame.rail;
          rail.visible = Math.abs(slide) > 1e-6;
          rail.scale.y = Math.max(Math.abs(slide), 1e-6);
          rail.position.copy(rail.userData.axis).multiplyScalar(-slide / 2);
        }
      });
      view.tip.copy(frames[count - 1].group.position);
      tipMark.position.copy(view.tip);
      if (path) path.upTo(at);
      if (view.target) view.target.position.copy(between(data.reference, where, 3, 0));
      const nearest = share < 0.5 ? at : next;
      let force = null;
      if (arrow) {
        const wrench = between(data.force, where, 3, 0);
        force = wrench.length();
        arrow.position.copy(view.tip);
        arrow.point(force > 0 ? wrench.clone().divideScalar(force) : new THREE.Vector3(0, 0, 1), force * view.forceScale);
      }
      readout(where, force, ellipsoids.map(({text, show}) => [text, show(nearest)]));
      view.draw();
    };

    const text = document.getElementById("readout");
    function readout(where, force, remarks) {
      const fixed = (value) => (value < 0 ? "−" : " ") + Math.abs(value).toFixed(4);
      const away = view.target ? view.tip.distanceTo(view.target.position) : NaN;
      text.textContent = "tip  x" + fixed(view.tip.x) + "  y" + fixed(view.tip.y) + "  z" + fixed(view.tip.z) + " m"
        + (isFinite(away) && away > 1e-7 ? "\nfrom the reference " + page.number(away, 3) + " m" : "")
        + (force === null ? "" : "\nforce on the tip " + page.number(force, 3) + " N")
        + remarks.filter(([, remark]) => remark).map(([name, remark]) => "\n" + name + " " + remark).join("");
    }

    // Where the mark of the tip was last drawn, m.
    view.drawnTip = () => new THREE.Vector3().setFromMatrixPosition(tipMark.matrixWorld).toArray();

    let waiting = false;
    view.draw = function () {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => { waiting = false; renderer.render(scene, camera); });
    };

    let wanted = new THREE.Vector3(1, -1.25, 0.62), moved = false;
    view.look = function (direction) {
      wanted = direction.clone().normalize();
      moved = false;
      const angle = Math.atan(Math.tan(camera.fov * Math.PI / 360) * Math.min(1, camera.aspect));
      controls.target.copy(middle);
      camera.position.copy(middle).addScaledVector(wanted, 0.56 * size / Math.sin(angle));
      camera.near = size / 100;
      camera.far = size * 60;
      camera.updateProjectionMatrix();
      controls.update();
      view.draw();
    };
    view.dolly = function (factor) {
      moved = true;
      const away = camera.position.clone().sub(controls.target);
      camera.position.copy(controls.target).addScaledVector(away, factor);
      controls.update();
      view.draw();
    };

    function fit() {
      const width = box.clientWidth, height = box.clientHeight;
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      renderer.setSize(width, height);
      for (const each of lines) each.resize(width, height);
      if (moved) view.draw(); else view.look(wanted);
    }

    box.appendChild(renderer.domElement);
    const controls = new THREE.OrbitControls(camera, box);
    controls.enableKeys = false;
    controls.enableZoom = false;  // the wheel scrolls the page until the view was clicked
    controls.rotateSpeed = 0.8;
    controls.addEventListener("change", view.draw);
    controls.addEventListener("start", () => { moved = true; });
    box.addEventListener("pointerdown", () => { controls.enableZoom = true; });
    box.addEventListener("pointerleave", () => { controls.enableZoom = false; });
    fit();
    new ResizeObserver(fit).observe(box);
    view.renderer = renderer;
    view.camera = camera;
    return view;
  }

  if (data) page.scene = make();
  else {
    box.classList.add("empty");
    box.textContent = "no motion to draw";
  }
})(window.osculate);
