// Checks every page of the built site with axe, WCAG 2 A and AA, in both themes and at two widths.
//
//     npm install --prefix build/axe axe-core puppeteer-core
//     NODE_PATH=build/axe/node_modules CHROMIUM=/usr/bin/chromium node packaging/site/check_axe.mjs dist/site [PICTURES]
//
// Prints each finding once with the pages that it is on, and ends with 1 where one is serious or critical. PICTURES gets
// a picture of each page. Nothing here is part of the site's build: it needs a browser.

import { createRequire } from "node:module";
import { readFileSync, readdirSync, mkdirSync } from "node:fs";
import { join, relative, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const load = createRequire(join(resolve(process.env.NODE_PATH ?? "node_modules"), "anything.js"));
const puppeteer = load("puppeteer-core");
const axe = readFileSync(load.resolve("axe-core/axe.min.js"), "utf-8");
const WIDTHS = [1280, 390];
const SCHEMES = ["light", "dark"];
const LEVELS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"];

const [site, pictures] = process.argv.slice(2).map((path) => resolve(path));
const only = process.env.ONLY ? new RegExp(process.env.ONLY) : /./;
const pages = readdirSync(site, { recursive: true, withFileTypes: true })
  .filter((one) => one.name.endsWith(".html") && one.name !== "404.html")
  .map((one) => join(one.parentPath, one.name))
  .filter((file) => only.test(relative(site, file)))
  .sort();

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--allow-file-access-from-files"],
});
const found = new Map();
let wide = 0;
for (const scheme of SCHEMES) {
  for (const width of WIDTHS) {
    const context = await browser.createBrowserContext(); // a theme that was chosen is remembered
    const page = await context.newPage();
    await page.setViewport({ width, height: 900 });
    await page.emulateMediaFeatures([
      { name: "prefers-color-scheme", value: scheme },
      { name: "prefers-reduced-motion", value: "reduce" },
    ]);
    for (const file of pages) {
      const name = relative(site, file);
      await page.goto(pathToFileURL(file).href, { waitUntil: "load" });
      await page.evaluate(() => document.fonts.ready);
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      if (overflow > 0) {
        wide += 1;
        console.log(`wider than its window by ${overflow} px: ${name} at ${width}`);
      }
      if (pictures) {
        mkdirSync(pictures, { recursive: true });
        const picture = `${name.replaceAll("/", "_").replace(".html", "")}-${width}-${scheme}.png`;
        await page.screenshot({ path: join(pictures, picture), clip: { x: 0, y: 0, width, height: 2200 } });
      }
      await page.evaluate(axe);
      const { violations } = await page.evaluate(
        (levels) => globalThis.axe.run(document, { runOnly: { type: "tag", values: levels } }),
        LEVELS,
      );
      for (const { id, impact, help, nodes } of violations) {
        const one = found.get(id) ?? { impact, help, places: new Map(), count: 0 };
        one.count += nodes.length;
        one.places.set(`${name} ${width} ${scheme}`, nodes[0].html.slice(0, 160));
        found.set(id, one);
      }
    }
    await context.close();
  }
}
await browser.close();

for (const [id, { impact, help, places, count }] of found) {
  console.log(`${impact}: ${id} (${help}), ${count} times, on ${places.size} pages, themes and widths`);
  for (const [place, html] of [...places].slice(0, 5)) console.log(`    ${place}: ${html}`);
}
const grave = [...found.values()].filter(({ impact }) => impact === "serious" || impact === "critical");
console.log(`${pages.length} pages, ${found.size} kinds of findings, ${grave.length} of them serious or critical.`);
process.exitCode = grave.length || wide ? 1 : 0;
