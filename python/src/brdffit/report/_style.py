"""What every page looks like: on a phone and a desk, light and dark, on paper. SPDX-License-Identifier: MIT"""

CSS = """
:root{color-scheme:light dark;--bg:#fff;--ink:#1d2329;--soft:#5b6672;--line:#d8dee4;--card:#f6f8fa;--ok:#1a7f37;--bad:#9a6700;
--c0:#c62828;--c1:#2e7d32;--c2:#1e5fc1;--c3:#1d2329;--bound:#8250df;--near:#d4a72c40}
@media (prefers-color-scheme:dark){:root{--bg:#0f1418;--ink:#e4e9ee;--soft:#9aa6b2;--line:#2f3943;--card:#171e24;--ok:#4ac26b;
--bad:#d4a72c;--c0:#ff7b72;--c1:#56d364;--c2:#79b8ff;--c3:#e4e9ee;--bound:#c297ff;--near:#d4a72c40}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:1180px;padding:16px;background:var(--bg);color:var(--ink);font:16px/1.5 system-ui,sans-serif;
overflow-wrap:anywhere}
h1{font-size:1.6rem;line-height:1.25;margin:.4em 0}h2{font-size:1.2rem;margin:2em 0 .4em;border-bottom:1px solid var(--line)}
a{color:var(--c2)}p{max-width:46em}.soft{color:var(--soft)}
.tables{display:flex;flex-wrap:wrap;gap:8px 32px}.scroll{overflow-x:auto;max-width:100%}
table{border-collapse:collapse;font-size:.92rem;font-variant-numeric:tabular-nums}
th,td{white-space:nowrap;padding:3px 10px 3px 0;text-align:right;border-bottom:1px solid var(--line);overflow-wrap:normal}
th:first-child,td:first-child{text-align:left}thead th{color:var(--soft);font-weight:500;white-space:normal;vertical-align:bottom}
td.left,th.left{text-align:left}td.words{white-space:normal;text-align:left;min-width:9em}tr.failed td{color:var(--bad)}
table.index th[scope=row]{white-space:normal;overflow-wrap:anywhere;min-width:6em}
td.ball{padding:2px 10px 2px 0}td.ball img{display:block;width:40px;height:40px}.failed{color:var(--bad)}
.badge{font-size:.8rem;font-weight:500;padding:2px 9px;border-radius:1em;border:1px solid var(--ok);color:var(--ok);white-space:nowrap;
vertical-align:middle}.badge.open{border-color:var(--bad);color:var(--bad)}summary{cursor:pointer;
margin:10px 0}
.certificate{background:var(--card);border-left:4px solid var(--ok);padding:10px 14px;margin:12px 0}
.certificate.open{border-color:var(--bad)}.certificate p{margin:.3em 0}
.grid{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(310px,100%),1fr));gap:12px}
.views{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(540px,100%),1fr));gap:12px}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(240px,100%),1fr))}
figure{margin:0;background:var(--card);padding:8px;border-radius:6px;min-width:0;break-inside:avoid}
figure svg,figure img{display:block;width:100%;max-width:520px;margin:auto;height:auto}
figure.wide{max-width:560px;margin-top:12px}
figcaption{font-size:.85rem;color:var(--soft);padding:6px 4px 0}
figure.ball{flex:0 1 220px}.balls{display:flex;flex-wrap:wrap;gap:12px}
.legend{display:flex;flex-wrap:wrap;gap:4px 16px;font-size:.9rem;color:var(--soft)}
.key::before{content:"";display:inline-block;width:.7em;height:.7em;border-radius:50%;background:currentColor;margin-right:.4em}
svg text{font:11px system-ui,sans-serif;fill:var(--soft)}
svg .grid{display:inline;stroke:var(--line);stroke-width:.6;fill:none}
.frame{stroke:var(--soft);stroke-width:.8;fill:none}.line{fill:none;stroke-width:1.4}.faint{stroke:var(--soft);stroke-width:.8}
.dot{fill:none;stroke-linecap:round;stroke-opacity:.75}.skipped{stroke-opacity:.25}
.c0{stroke:var(--c0);color:var(--c0)}.c1{stroke:var(--c1);color:var(--c1)}.c2{stroke:var(--c2);color:var(--c2)}
.c3{stroke:var(--c3);color:var(--c3)}.bound{stroke:var(--bound);color:var(--bound)}.exact{stroke:var(--ink);color:var(--ink)}.dash{stroke-dasharray:4 3}
.key.near{color:#d4a72c}.key.square::before{border-radius:0}
.best{stroke:var(--c0);stroke-opacity:1}.near{fill:var(--near)}.ground{fill:var(--card);fill-opacity:.85}.boxes{fill:none;stroke:#fff;stroke-opacity:.45;stroke-width:.35}
@media (max-width:480px){table{font-size:.69rem}th,td{padding-right:3px}th:last-child,td:last-child{padding-right:0}table.index .less{display:none}
table.index .each span{display:block}}
@page{margin:14mm}
@media print{:root{color-scheme:light;--bg:#fff;--ink:#000;--soft:#444;--line:#ccc;--card:#fff;--ok:#1a7f37;--bad:#9a6700;--c0:#c62828;
--c1:#2e7d32;--c2:#1e5fc1;--c3:#1d2329;--bound:#8250df;--near:#d4a72c40}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}
body{max-width:none;padding:0 2px;font-size:10pt}h2+p{break-after:avoid}p{max-width:none}h2{margin-top:1.2em;break-after:avoid}.legend{break-after:avoid}
.tables,.certificate,.balls,.keep,tr{break-inside:avoid}.scroll{overflow:visible}th,td{padding-right:8px}table{font-size:8.5pt}
.grid{grid-template-columns:repeat(2,1fr)}.views{grid-template-columns:1fr}.pair{grid-template-columns:1fr 1fr}
figure{border:1px solid var(--line);padding:4px}details{display:none}.noprint{display:none}}
"""
