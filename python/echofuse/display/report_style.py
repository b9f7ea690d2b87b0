"""The style sheet of the report."""

STYLE_SHEET = """
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0; background: #fff; color: #1a1a1a;
  font: 16px/1.5 "Segoe UI", "Helvetica Neue", "Liberation Sans", Arial, sans-serif; }
main { max-width: 1040px; margin: 0 auto; padding: 40px 24px 64px; }
header { border-bottom: 2px solid #1a1a1a; padding-bottom: 20px; }
.kind { margin: 0; font-size: 13px; letter-spacing: .06em; text-transform: uppercase; color: #5c6068; }
h1 { margin: 4px 0 18px; font-size: 30px; line-height: 1.2; overflow-wrap: anywhere; }
h2 { margin: 44px 0 12px; font-size: 21px; }
h3 { margin: 26px 0 8px; font-size: 16px; overflow-wrap: anywhere; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 4px 22px; margin: 0; font-size: 15px; }
dt { color: #5c6068; }
dd { margin: 0; overflow-wrap: anywhere; }
table { border-collapse: collapse; font-size: 15px; font-variant-numeric: tabular-nums; }
th, td { padding: 6px 14px 6px 0; text-align: right; vertical-align: baseline;
  border-bottom: 1px solid #e2e4e8; }
th[scope="row"], thead th:first-child { text-align: left; font-weight: normal; }
thead th { border-bottom: 1.5px solid #1a1a1a; font-weight: 600; }
.metrics { width: 100%; }
.metrics td:nth-child(2) { font-weight: 600; }
.metrics td:nth-child(4) { color: #5c6068; }
.counters { font-size: 13.5px; }
.counters thead th { font-weight: 600; max-width: 110px; vertical-align: bottom; }
code { font: 12.5px "DejaVu Sans Mono", Consolas, monospace; color: #6b6f76; padding-left: 6px; }
td.zero { color: #9aa0a8; }
td.marked { font-weight: 700; color: #8c2f00; background: #fdeadf; }
figure { margin: 0 0 30px; break-inside: avoid; }
figure img { display: block; width: 100%; height: auto; }
figcaption { margin-top: 8px; max-width: 82ch; font-size: 14px; color: #40444b; }
summary { cursor: pointer; padding: 8px 0; font-size: 15px; color: #0059a0; overflow-wrap: anywhere; }
.note { font-size: 13.5px; color: #5c6068; max-width: 82ch; }
@media print {
  @page { margin: 14mm; }
  body { font-size: 11pt; }
  main { max-width: none; padding: 0; }
  h2, h3 { break-after: avoid; }
  td.marked { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
"""
