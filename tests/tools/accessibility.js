// Pages tried with axe, by colours of the day and of the night, and at the width of a phone.
//
//     cd $(mktemp -d) && npm install axe-core playwright-core
//     NODE_PATH=$PWD/node_modules node REPOSITORY/tests/tools/accessibility.js [--pictures FOLDER] PAGE.html ...
//
// Needs Chromium (CHROMIUM, or /usr/bin/chromium). Prints what a page violates of WCAG 2.2 A and AA and of axe's best
// practice, and its width on a window of 390 px; ends with 1 where a page violates a rule or is wider.
const { chromium } = require("playwright-core");
const { readFileSync } = require("fs");
const { basename, dirname, join, resolve } = require("path");

const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
const RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"];
const FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run"];
const PHONE = { width: 390, height: 844 };

async function violations(page, colorScheme) {
  await page.emulateMedia({ colorScheme });
  await page.waitForTimeout(300);
  await page.evaluate(axe);
  const found = await page.evaluate((values) => axe.run(document, { runOnly: values }), RULES);
  return found.violations.map((rule) => {
    const places = rule.nodes.map((node) => node.target.join(" ")).slice(0, 5);
    return `${colorScheme}: ${rule.impact}, ${rule.id}, ${rule.nodes.length} times: ${places.join("; ")}`;
  });
}

async function tried(browser, file, pictures) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  const lines = [];
  page.on("pageerror", (error) => lines.push(`error of a script: ${error}`));
  await page.goto(`file://${resolve(file)}`);
  lines.push(...(await violations(page, "light")), ...(await violations(page, "dark")));
  await page.emulateMedia({ colorScheme: "light" });
  await page.setViewportSize(PHONE);
  await page.waitForTimeout(300);
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  if (width > PHONE.width) lines.push(`${width} px wide on a phone of ${PHONE.width}`);
  if (pictures) {
    const name = `${basename(dirname(resolve(file)))}-${basename(file, ".html")}.png`;
    await page.screenshot({ path: join(pictures, name), fullPage: true });
  }
  await page.close();
  return lines;
}

(async () => {
  const files = process.argv.slice(2);
  const pictures = files[0] === "--pictures" ? files.splice(0, 2)[1] : null;
  const executablePath = process.env.CHROMIUM || "/usr/bin/chromium";
  const browser = await chromium.launch({ executablePath, args: FLAGS });
  let n = 0;
  for (const file of files) {
    const lines = await tried(browser, file, pictures);
    n += lines.length;
    console.log(lines.length ? `${file}\n  ${lines.join("\n  ")}` : `${file}: nothing`);
  }
  await browser.close();
  console.log(`${files.length} pages, ${n} findings`);
  process.exitCode = n ? 1 : 0;
})();
