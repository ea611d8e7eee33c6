// The bar under a motion: play and halt it, move through it, change its speed.

import {button, element, svg} from "../common/elements.js"

const SPEEDS = [0.25, 0.5, 1, 2]
const PLAY = svg('<path d="M8 5v14l11-7z"/>')
const PAUSE = svg('<path d="M6 5h4v14H6zM14 5h4v14h-4z"/>')

export class Transport {
  /** `play(on)` and `seek(seconds)` hear what a person does. @param {Overlay} overlay */
  constructor(overlay, {play, seek}) {
    this.overlay = overlay
    this.place = overlay.transport
    this.speed = 1
    this.button = button({on: {click: () => play(!this.playing)}})
    this.track = element("input", {
      type: "range", min: 0, step: 0.001, aria: {label: "Time in the motion"},
      on: {input: () => seek(Number(this.track.value))},
    })
    this.clock = element("output")
    this.rate = button({on: {click: () => {
      this.speed = SPEEDS[(SPEEDS.indexOf(this.speed) + 1) % SPEEDS.length]
      this.label()
    }}})
    this.place.append(this.button, this.track, this.clock, this.rate)
    this.label()
    this.show(null, false)
  }

  label() {
    this.rate.textContent = `${{0.25: "¼", 0.5: "½"}[this.speed] || this.speed}×`
    this.rate.setAttribute("aria-label", `Speed: ${this.speed} times; press for another`)
  }

  show(clip, playing) {
    this.playing = playing
    this.place.hidden = !clip
    this.overlay.root.classList.toggle("moving", Boolean(clip))
    if (clip) { this.track.max = clip.duration }
    this.button.innerHTML = playing ? PAUSE : PLAY
    this.button.setAttribute("aria-label", playing ? "Pause the motion" : "Play the motion")
  }

  tick(clip, time) {
    const now = clip.moment(time)
    this.track.value = now
    this.clock.textContent = `${now.toFixed(2)} / ${clip.duration.toFixed(2)} s`
  }
}
