//! The page of all plates: one HTML file that needs nothing from elsewhere.

use std::fmt::Write;

use crate::picture::base64;
use crate::plate::{Plate, Verdict};
use crate::svg::escape;

/// One figure of the index.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Its number.
    pub id: String,
    /// The chapter it belongs to; entries of one chapter follow each other.
    pub chapter: String,
    /// Its title.
    pub title: String,
    /// The sentence it claims.
    pub claim: String,
    /// Whether the claim holds.
    pub verdict: Verdict,
    /// How long it took to make.
    pub seconds: f64,
    /// The caption as plain text; line breaks are kept.
    pub caption: String,
    /// The plate as a PNG file, embedded in the page.
    pub png: Vec<u8>,
    /// Paths of the data files, relative to the page, with forward slashes.
    pub files: Vec<String>,
}

impl Entry {
    /// The entry of a plate whose PNG file is `png`.
    pub fn of(plate: &Plate, chapter: impl Into<String>, seconds: f64, png: Vec<u8>) -> Self {
        Self {
            id: plate.id().to_owned(),
            chapter: chapter.into(),
            title: plate.title().to_owned(),
            claim: plate.claim().to_owned(),
            verdict: plate.verdict(),
            seconds,
            caption: plate.caption(),
            png,
            files: Vec::new(),
        }
    }

    /// With a link to a data file.
    pub fn file(mut self, path: impl Into<String>) -> Self {
        self.files.push(path.into());
        self
    }
}

const STYLE: &str = "\
:root{color-scheme:light}
body{margin:0 auto;max-width:1400px;padding:40px 32px 80px;background:#fff;color:#1c1f24;font:17px/1.5 'DejaVu Sans',Verdana,sans-serif}
h1{font-size:34px;margin:0 0 4px;color:#2b3a55}h2{font-size:25px;margin:48px 0 16px;border-bottom:2px solid #dfe3e8;padding-bottom:6px;color:#2b3a55}
.summary{color:#555b66;margin:0}
.sheet{display:grid;grid-template-columns:repeat(3,minmax(0,1fr));gap:36px 32px}
@media(max-width:1100px){.sheet{grid-template-columns:repeat(2,minmax(0,1fr))}}
@media(max-width:700px){.sheet{grid-template-columns:minmax(0,1fr)}}
figure{margin:0;display:flex;flex-direction:column}
figure button{padding:0;border:1px solid #dfe3e8;background:#fff;cursor:zoom-in;width:100%;height:300px;overflow:hidden;display:flex;align-items:flex-start}
figure img{width:100%;height:auto;display:block}
h3{font-size:19px;line-height:1.3;margin:14px 0 6px}h3 span{font-weight:normal;color:#555b66}
.badge{color:#fff;font-weight:bold;font-size:15px;border-radius:4px;padding:2px 8px;margin-right:8px;white-space:nowrap}
p{margin:0 0 8px}details{color:#555b66;font-size:15px;white-space:pre-line}a{color:#0072b2}
dialog{max-width:96vw;max-height:96vh;padding:0;border:0;cursor:zoom-out}dialog img{display:block;max-width:100%}dialog::backdrop{background:#000b}
";

const SCRIPT: &str = "\
const view=document.querySelector('dialog');
view.onclick=()=>view.close();
for(const button of document.querySelectorAll('figure button'))button.onclick=()=>{
const plate=button.firstElementChild;view.firstElementChild.src=plate.src;view.firstElementChild.alt=plate.alt;view.showModal();};
";

/// The page of `entries`, in chapters as they come.
pub fn index_html(title: &str, entries: &[Entry]) -> String {
    let title = escape(title);
    let holding = entries.iter().filter(|entry| entry.verdict == Verdict::Holds).count();
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n\
         <p class=\"summary\">{holding} of {} claims hold. Click a plate to enlarge it.</p>\n",
        entries.len()
    );
    for chapter in entries.chunk_by(|a, b| a.chapter == b.chapter) {
        let _ = writeln!(html, "<h2>{}</h2>\n<div class=\"sheet\">", escape(&chapter[0].chapter));
        for entry in chapter {
            html.push_str(&figure(entry));
        }
        html.push_str("</div>\n");
    }
    let _ = writeln!(
        html,
        "<dialog><img src=\"data:,\" alt=\"\"></dialog>\n<script>\n{SCRIPT}</script>\n</body>\n</html>"
    );
    html
}

fn figure(entry: &Entry) -> String {
    let [red, green, blue] = entry.verdict.color().rgb;
    let (id, title) = (escape(&entry.id), escape(&entry.title));
    let links: Vec<String> = entry.files.iter().map(|path| link(path)).collect();
    format!(
        "<figure id=\"{id}\">\n<button type=\"button\"><img loading=\"lazy\" alt=\"{id} {title}\" \
         src=\"data:image/png;base64,{}\"></button>\n<figcaption>\n<h3><span>{id}</span> {title}</h3>\n\
         <p><span class=\"badge\" style=\"background:#{red:02x}{green:02x}{blue:02x}\">{}</span>{}</p>\n\
         <details><summary>Made in {:.1} s</summary>{}</details>\n<p>{}</p>\n</figcaption>\n</figure>\n",
        base64(&entry.png),
        entry.verdict.text(),
        escape(&entry.claim),
        entry.seconds,
        escape(&entry.caption),
        links.join(" · "),
    )
}

/// A link that shows the file's name without its folders.
fn link(path: &str) -> String {
    let name = path.rsplit('/').next().unwrap_or(path);
    format!("<a href=\"{}\">{}</a>", escape(path), escape(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(id: &str, chapter: &str) -> Entry {
        let plate = Plate::new(id, "<b>", "a & b < \"c\"", false).note("Method", "<script>");
        Entry::of(&plate, chapter, 1.25, vec![1, 2, 3]).file("1/data.csv")
    }

    #[test]
    fn everything_is_escaped_and_nothing_comes_from_elsewhere() {
        let html = index_html(
            "L'index <1>",
            &[entry("1.1", "One"), entry("1.2", "One"), entry("2.1", "Two")],
        );
        assert!(html.contains("a &amp; b &lt; &quot;c&quot;"));
        assert!(html.contains("L&#39;index &lt;1&gt;"));
        assert!(html.contains("Method: &lt;script&gt;"));
        assert_eq!(html.matches("<script>").count(), 1, "only the page's own");
        assert!(!html.contains("http"), "no address of another place");
        assert_eq!((html.matches("<h2>").count(), html.matches("<figure ").count()), (2, 3));
        assert!(html.contains("0 of 3 claims hold"));
        assert!(html.contains("<a href=\"1/data.csv\">data.csv</a>"));
        assert!(html.contains("base64,AQID"));
    }
}
