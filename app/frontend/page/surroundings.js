// What surrounds the canvas on a page with a server: keys, files that are dropped, the browser's
// Back, the connection, the widget library.

import {Connection} from "./connection.js"
import {copyLink} from "../common/clipboard.js"
import {Keys} from "./keys.js"
import {Mui} from "./mui.js"
import {acceptDrops, Uploader} from "./upload.js"

export class Surroundings {
  constructor(view) {
    const {model, overlay} = view
    this.uploader = new Uploader(model, {
      started: (files) => {
        const names = files.map(({name}) => name).join(", ")
        overlay.say(`Sending ${names}`, () => this.uploader.cancel())
      },
      ended: () => overlay.say(null),
    })
    const over = (hanging) => overlay.say(hanging ? "Drop the character here" : null)
    acceptDrops(overlay.root, over, (files) => this.uploader.send(files))
    this.keys = new Keys(overlay, {
      act: (act) => {
        if (act === "strongest") { view.pointer.strongest(); return }
        model.send_msg({type: "act", act})
      },
      link: () => { view.addressBar.rested(); copyLink(overlay, view.link) },
      painting: () => Boolean(view.brush.part),
      turnable: () => overlay.canvas.matches(":focus") && !view.orbit.byMouse,
    })
    this.wentBack = () => {
      view.addressBar.stop()
      model.send_msg({type: "visit", query: location.search})
    }
    window.addEventListener("popstate", this.wentBack)
    this.connection = new Connection(overlay)
    this.mui = new Mui(overlay.root)
  }

  remove() {
    window.removeEventListener("popstate", this.wentBack)
    for (const part of [this.uploader, this.keys, this.connection, this.mui]) { part.remove() }
  }
}
