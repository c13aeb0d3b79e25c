//! A page in headless Chromium.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Chromium, by the environment variable `CHROMIUM` or in the path.
fn chromium() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome", "chrome-headless-shell"];
    let path = std::env::var_os("PATH").unwrap_or_default();
    let mut all = std::env::split_paths(&path).flat_map(|d| names.map(|n| d.join(n)));
    std::env::var_os("CHROMIUM").map(PathBuf::from).or_else(|| all.find(|p| p.is_file()))
}

/// Opens a page from disk, runs a script behind its own, and returns the attributes of its `<html>`: `data-errors` is there if anything
/// went wrong. `None`, and a word, without a browser.
pub fn attributes(folder: &Path, page: &str, script: &str) -> Option<String> {
    let Some(chromium) = chromium() else {
        println!("skipped: no Chromium in the path (or in the environment variable CHROMIUM)");
        return None;
    };
    let watch = "<script>addEventListener('error', e => document.documentElement.dataset.errors = e.message)</script>";
    let page = page.replacen("<h1>", &format!("{watch}<h1>"), 1).replace("</html>", &format!("{script}</html>"));
    let path = folder.join("page.html");
    fs::write(&path, page).unwrap();
    let output = Command::new(chromium)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1000,900", "--dump-dom"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("file://{}", path.display()))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    Some(dom.split_once("<html").map(|(_, rest)| rest.split('>').next().unwrap().to_string()).unwrap_or_default())
}
