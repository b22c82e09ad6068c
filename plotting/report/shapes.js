// Solid bodies of the scene, all in m: rods, hubs, arrows, ellipsoids, lines. `paint` says whether WebGL or SVG draws them.
(function (page) {
  "use strict";
  const up = new THREE.Vector3(0, 1, 0);  // axis of three.js's cylinders

  // Makers of bodies for one renderer. Without WebGL: few faces, flat colours.
  page.shapes = function (webgl) {
    const around = webgl ? 28 : 8;
    const shapes = {};

    shapes.material = function (colour, opacity = 1) {
      const options = {color: new THREE.Color(colour), opacity: opacity, transparent: opacity < 1, depthWrite: opacity === 1};
      return webgl ? new THREE.MeshPhongMaterial({...options, shininess: 25, specular: new THREE.Color("#333333")})
                   : new THREE.MeshLambertMaterial(options);
    };

    const mesh = (geometry, material) => new THREE.Mesh(geometry, material);

    // A cylinder or cone from point a to point b.
    shapes.rod = function (a, b, radiusA, radiusB, material) {
      const along = b.clone().sub(a), length = along.length();
      const body = mesh(new THREE.CylinderGeometry(radiusB, radiusA, length, around, 1), material);
      body.position.copy(a).addScaledVector(along, 0.5);
      body.quaternion.setFromUnitVectors(up, along.divideScalar(length || 1));
      return body;
    };

    shapes.ball = (radius, material) => mesh(new THREE.SphereGeometry(radius, around, webgl ? 18 : 5), material);
    shapes.box = (x, y, z, material) => mesh(new THREE.BoxGeometry(x, y, z), material);

    // A disc or drum about an axis.
    shapes.drum = function (axis, radius, height, material) {
      const half = axis.clone().multiplyScalar(height / 2);
      return shapes.rod(half.clone().negate(), half, radius, radius, material);
    };

    // A square bar along an axis, for joints that slide.
    shapes.bar = function (axis, width, height, material) {
      const body = shapes.box(width, height, width, material);
      body.quaternion.setFromUnitVectors(up, axis);
      return body;
    };

    // A primitive of the URDF text in its link's frame.
    shapes.visual = function (visual, material) {
      const [a, b, c] = visual.size;
      const inner = visual.shape === "box" ? shapes.box(a, b, c, material)
        : visual.shape === "sphere" ? shapes.ball(a, material)
        : shapes.drum(new THREE.Vector3(0, 0, 1), a, b, material);
      const outer = new THREE.Group();
      outer.add(inner);
      outer.position.fromArray(visual.position);
      outer.quaternion.copy(shapes.quaternion(visual.rotation, 0));
      return outer;
    };

    // Quaternion w x y z from an array.
    shapes.quaternion = (array, at) => new THREE.Quaternion(array[at + 1], array[at + 2], array[at + 3], array[at]);

    // A line through points (x, y, z, x, y, z, ...), `width` in pixels; line.upTo(n) shows its first n pieces. Lines of a
    // higher `order` are drawn over those of a lower one where both are equally near.
    shapes.line = function (points, colour, width, opacity = 1, order = 0) {
      let line;
      if (webgl) {
        const geometry = new THREE.LineGeometry().setPositions(points);
        const material = new THREE.LineMaterial({color: new THREE.Color(colour), linewidth: width, transparent: true, opacity: opacity,
                                                  depthWrite: false});
        line = new THREE.Line2(geometry, material);
        line.upTo = (count) => { geometry.maxInstancedCount = count; };
        line.resize = (x, y) => material.resolution.set(x, y);
      } else {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
        line = new THREE.Line(geometry, new THREE.LineBasicMaterial({color: new THREE.Color(colour), linewidth: width, opacity: opacity}));
        line.upTo = () => {};  // SVG draws whole lines
        line.resize = () => {};
      }
      line.renderOrder = order;
      line.frustumCulled = false;
      return line;
    };

    // An arrow from its origin; arrow.point(vector, length) turns and stretches it.
    shapes.arrow = function (radius, colour) {
      const arrow = new THREE.Group(), material = shapes.material(colour);
      const shaft = shapes.rod(new THREE.Vector3(), up, radius, radius, material);
      const head = shapes.rod(new THREE.Vector3(), new THREE.Vector3(0, 4.5 * radius, 0), 2.4 * radius, 0, material);
      arrow.add(shaft, head);
      arrow.point = function (direction, length) {
        arrow.visible = length > 0;
        if (!arrow.visible) return;
        arrow.quaternion.setFromUnitVectors(up, direction);
        const slim = Math.min(1, length / (9 * radius)), tip = 4.5 * radius * slim;  // a short arrow is thinner
        shaft.scale.set(slim, length - tip, slim);
        shaft.position.set(0, (length - tip) / 2, 0);
        head.scale.set(slim, slim, slim);
        head.position.set(0, length - tip / 2, 0);
      };
      return arrow;
    };

    // Three lines along x, y, z.
    shapes.triad = function (length) {
      const group = new THREE.Group();
      for (const [i, name] of ["series-1", "series-2", "series-0"].entries()) {
        const end = [0, 0, 0];
        end[i] = length;
        group.add(shapes.line([0, 0, 0, ...end], page.colour(name), 2.5));
      }
      return group;
    };

    return shapes;
  };
})(window.osculate);
