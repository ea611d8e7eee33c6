// Skinning on the graphics card: influences are sent to it once, and after that a matrix a joint
// for each pose, kept in a texture that all actors read. Matrices or dual quaternions are blended.

import {DUAL_SHADER, dualSkinned} from "./dual_quaternions.js"
import {plain} from "../common/panel.js"
import {trueCoordinates, VERTEX} from "./vtk_private.js"

const POSE_UNIT = 15  // the last texture unit that every WebGL 2 has; vtk.js takes the first ones

export class PoseTexture {
  constructor(gl) {
    this.gl = gl
    this.texture = gl.createTexture()
    this.rows = 0
    this.on = false
  }

  // `pose`: a Float32Array of row-major 4 by 4 matrices, or null at rest. `dual`: their last rows
  // are quaternions, to be blended.
  set(pose, dual) {
    this.on = Boolean(pose)
    this.dual = dual
    if (!pose) { return }
    const {gl} = this
    const rows = pose.length / 16
    this.bind()
    if (rows === this.rows) {
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 4, rows, gl.RGBA, gl.FLOAT, pose)
    } else {
      for (const name of ["MIN_FILTER", "MAG_FILTER"]) {
        gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.NEAREST)
      }
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 4, rows, 0, gl.RGBA, gl.FLOAT, pose)
      this.rows = rows
    }
    gl.activeTexture(gl.TEXTURE0)
  }

  bind() {
    const {gl} = this
    gl.activeTexture(gl.TEXTURE0 + POSE_UNIT)
    gl.bindTexture(gl.TEXTURE_2D, this.texture)
  }

  // Called by vtk.js before it draws an actor.
  use(program, buffer, unit) {
    if (!program.isUniformUsed("poseOn")) { return }
    this.bind()
    this.gl.activeTexture(this.gl.TEXTURE0)
    program.setUniformi("poses", POSE_UNIT)
    program.setUniformf("poseOn", this.on && this.rows ? 1 : 0)
    program.setUniformf("poseDual", this.dual ? 1 : 0)
    const {scale, shift} = trueCoordinates(buffer)  // poses need them
    program.setUniform3fArray("trueScale", scale)
    program.setUniform3fArray("trueShift", shift)
    if (program.isUniformUsed("apartUnit")) { program.setUniformf("apartUnit", unit) }
  }

  remove() {
    this.gl.deleteTexture(this.texture)
  }
}

// A skin with other influences of some points: `rows` is a skin with a row for each of them.
export function withRows({joints, weights, count}, points, rows) {
  const wide = Math.max(count, rows.count)
  const joined = (own, others) => {
    const made = new own.constructor(own.length / count * wide)
    for (let i = 0; i < own.length / count; i++) {
      made.set(own.subarray(i * count, (i + 1) * count), i * wide)
    }
    points.forEach((point, i) => {
      made.fill(0, point * wide, (point + 1) * wide)
      made.set(others.subarray(i * rows.count, (i + 1) * rows.count), point * wide)
    })
    return made
  }
  return {joints: joined(joints, rows.joints), weights: joined(weights, rows.weights), count: wide}
}

// The arrays that carry a skin to the card, by the name of their attribute: four influences each.
export function skinArrays(name, {joints, weights, count}) {
  const arrays = []
  const n = joints.length / count
  for (let first = 0; first < count; first += 4) {
    const [j, w] = [new Float32Array(4 * n), new Float32Array(4 * n)]
    for (let i = 0; i < n; i++) {
      for (let k = first; k < Math.min(first + 4, count); k++) {
        j[4 * i + k - first] = joints[i * count + k]
        w[4 * i + k - first] = weights[i * count + k]
      }
    }
    arrays.push([`${name}Joints${first / 4}`, j], [`${name}Weights${first / 4}`, w])
  }
  return arrays
}

// Additions to the vertex shader of vtk.js. `otherSets`: of a second skin; how far it takes a point
// from where the first one does is the point's value.
export function skinVertex(sets, otherSets) {
  if (!sets) { return {declared: "", main: "", swaps: []} }
  const attributes = (name, count) => Array.from({length: count}, (_, s) =>
    `attribute vec4 ${name}Joints${s}MC; attribute vec4 ${name}Weights${s}MC;`).join("\n")
  const blend = (name, count, add, sums) => Array.from({length: count}, (_, s) =>
    ["x", "y", "z", "w"].map((c) =>
      `${add}(${name}Joints${s}MC.${c}, ${name}Weights${s}MC.${c}, ${sums}, held);`).join("\n"),
  ).join("\n")
  const blender = (name, count) => `
  void ${name}Blend(vec4 point, out vec4 a, out vec4 b, out vec4 c) {
    float held = 0.0;
    a = vec4(0.0); b = vec4(0.0); c = vec4(0.0);
    if (poseOn > 0.5 && poseDual > 0.5) {
      vec4 first = vec4(0.0); vec4 real = vec4(0.0); vec4 dual = vec4(0.0);
      ${blend(name, count, "addDual", "point, first, real, dual")}
      if (held != 0.0) { dualRows(real, dual, a, b, c); }
    } else if (poseOn > 0.5) {
      ${blend(name, count, "addPose", "a, b, c")}
    }
    if (held == 0.0) { a = vec4(1, 0, 0, 0); b = vec4(0, 1, 0, 0); c = vec4(0, 0, 1, 0); }
  }`
  const turned = "vec3(dot(rowX.xyz, normalMC), dot(rowY.xyz, normalMC), dot(rowZ.xyz, normalMC))"
  return {
    declared: `
  ${attributes("skin", sets)}
  ${otherSets ? attributes("other", otherSets) : ""}
  uniform highp sampler2D poses;
  uniform float poseOn;
  uniform float poseDual;
  uniform vec3 trueScale;
  uniform vec3 trueShift;
  uniform float apartUnit;
  vec4 rowX; vec4 rowY; vec4 rowZ; vec4 posedMC; float apart;
  void addPose(float joint, float w, inout vec4 a, inout vec4 b, inout vec4 c, inout float held) {
    if (w == 0.0) { return; }
    int row = int(joint + 0.5);
    a += w * texelFetch(poses, ivec2(0, row), 0);
    b += w * texelFetch(poses, ivec2(1, row), 0);
    c += w * texelFetch(poses, ivec2(2, row), 0);
    held += w;
  }
  ${DUAL_SHADER}
  ${blender("skin", sets)}
  ${otherSets ? blender("other", otherSets) : ""}`,
    main: `
    vec4 truePoint = vec4(vertexMC.xyz * trueScale + trueShift, 1.0);
    skinBlend(truePoint, rowX, rowY, rowZ);
    vec3 posed = vec3(dot(rowX, truePoint), dot(rowY, truePoint), dot(rowZ, truePoint));
    posedMC = vec4((posed - trueShift) / trueScale, 1.0);
    ${otherSets ? `vec4 a; vec4 b; vec4 c;
    otherBlend(truePoint, a, b, c);
    vec3 gap = posed - vec3(dot(a, truePoint), dot(b, truePoint), dot(c, truePoint));
    apart = apartUnit * length(gap);` : ""}`,
    swaps: [
      ...[VERTEX.seen, VERTEX.placed, VERTEX.cut].map((line) =>
        [line, line.replace("vertexMC", "posedMC")]),
      [VERTEX.normal, VERTEX.normal.replace("normalMC", turned)],
    ],
  }
}

// The same for all points, on the processor: to know where they are, not to draw them.
export function skinned(skin, rest, pose, dual = false) {
  if (dual) { return dualSkinned(skin, rest, pose) }
  const {joints, weights, count} = skin
  const out = new Float32Array(rest.length)
  for (let i = 0, n = rest.length / 3; i < n; i++) {
    const [x, y, z] = [rest[3 * i], rest[3 * i + 1], rest[3 * i + 2]]
    let held = 0
    for (let k = i * count; k < (i + 1) * count; k++) {
      const w = weights[k]
      if (w === 0) { continue }
      held += w
      for (let r = 0; r < 3; r++) {
        const at = joints[k] * 16 + 4 * r
        out[3 * i + r] += w * (pose[at] * x + pose[at + 1] * y + pose[at + 2] * z + pose[at + 3])
      }
    }
    if (held === 0) { out.set([x, y, z], 3 * i) }
  }
  return out
}

export function transformed(point, pose, joint) {
  if (!pose) { return point }
  const m = pose.subarray(joint * 16, joint * 16 + 12)
  const [x, y, z] = point
  return [0, 4, 8].map((r) => m[r] * x + m[r + 1] * y + m[r + 2] * z + m[r + 3])
}

// A motion that came as frames, read at any time.
export class Clip {
  constructor({times, matrices}) {
    this.times = plain(times)
    this.matrices = plain(matrices)
    this.size = this.matrices.length / this.times.length
    this.pose = new Float32Array(this.size)
    this.next = 1
  }

  get duration() {
    return this.times[this.times.length - 1] || 1
  }

  // It repeats; its end is a separate moment, as in `pose_at`.
  moment(time) {
    return time >= 0 && time <= this.duration ? time : time % this.duration
  }

  at(time) {
    const {times, size, matrices, pose} = this
    const t = this.moment(time)
    const final = times.length - 1
    // Most often it is the same frame as before, or the next one.
    let next = Math.min(this.next, final)
    if (times[Math.max(next - 1, 0)] > t) { next = Math.min(1, final) }
    while (next < final && times[next] <= t) { next += 1 }
    this.next = next
    const last = Math.max(next - 1, 0)
    const span = times[next] - times[last]
    const f = span > 0 ? (t - times[last]) / span : 1  // without one: at the end
    for (let i = 0, a = last * size, b = next * size; i < size; i++) {
      pose[i] = (1 - f) * matrices[a + i] + f * matrices[b + i]
    }
    return pose
  }
}
