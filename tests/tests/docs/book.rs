//! The book that the documents are.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use libtest_mimic::Failed;
use mindgap_tests::command::{Sandbox, workspace};
use mindgap_tests::rooms::SCENE;

use crate::{PAGES, documents, is_asked_for};

const SUMMARY: &str = "docs/SUMMARY.md";

/// What mdbook would leave out, and what it would not find.
pub fn every_document_is_in_the_summary_once() -> Result<(), Failed> {
    let summary = fs::read_to_string(workspace().join(SUMMARY))?;
    let listed: Vec<PathBuf> = links(&summary).into_iter().map(|link| Path::new("docs").join(link)).collect();
    let once: BTreeSet<PathBuf> = listed.iter().cloned().collect();
    let there: BTreeSet<PathBuf> = documents()
        .into_iter()
        .filter(|name| name.starts_with("docs/") && name != SUMMARY)
        .map(PathBuf::from)
        .collect();
    if listed.len() != once.len() || once != there {
        return Err(format!("listed {listed:#?}\nthere {there:#?}").into());
    }
    Ok(())
}

/// The reader of the tutorial has to have the room in which it is run.
pub fn the_tutorial_shows_its_scene() -> Result<(), Failed> {
    let text = fs::read_to_string(workspace().join("docs/tutorial.md"))?;
    if text.contains(&format!("```toml\n{SCENE}```")) { Ok(()) } else { Err("it shows another scene".into()) }
}

/// Links to other files; those into the web are not looked up. In the built book only files below `docs` exist.
pub fn every_link_leads_somewhere() -> Result<(), Failed> {
    let mut broken = Vec::new();
    for name in documents() {
        let path = workspace().join(&name);
        let folder = path.parent().ok_or("a document lies in a folder")?;
        for link in links(&fs::read_to_string(&path)?) {
            let target = folder.join(&link);
            let leads = if name.starts_with("docs/") { is_file_of_the_book(&target) } else { target.exists() };
            if !leads && !link.contains("://") {
                broken.push(format!("{name}: {link}"));
            }
        }
    }
    if broken.is_empty() { Ok(()) } else { Err(broken.join("\n").into()) }
}

/// `mindgap manual --format markdown --out docs/commands --force` updates them.
pub fn pages_are_those_of_the_command() -> Result<(), Failed> {
    let sandbox = Sandbox::new();
    sandbox.run("manual --format markdown --out pages");
    let written: Vec<(PathBuf, Vec<u8>)> =
        sandbox.files("pages").into_iter().map(|(name, bytes)| (Path::new(PAGES).join(name), bytes)).collect();
    let stale = written.iter().filter(|(path, bytes)| fs::read(workspace().join(path)).ok().as_ref() != Some(bytes));
    let stale: Vec<String> = stale.map(|(path, _)| path.display().to_string()).collect();
    let there = documents().into_iter().filter(|name| name.starts_with(PAGES)).count();
    if !stale.is_empty() || there != written.len() {
        return Err(format!("update them with mindgap manual: {} of {there} differ: {stale:?}", stale.len()).into());
    }
    Ok(())
}

/// `mindgap explain --markdown > docs/reference/catalogue.md` updates it, and so does `MINDGAP_DOCS=overwrite`.
pub fn the_catalogue_of_effects_is_that_of_the_command() -> Result<(), Failed> {
    let written = Sandbox::new().run("explain --markdown");
    let path = workspace().join("docs/reference/catalogue.md");
    if is_asked_for("overwrite") {
        fs::write(&path, &written)?;
    }
    if fs::read_to_string(path)? == written {
        Ok(())
    } else {
        Err("docs/reference/catalogue.md differs from mindgap explain".into())
    }
}

/// `mindgap schema --out docs/reference/schemas --force` updates them, and so does `MINDGAP_DOCS=overwrite`.
pub fn schemas_are_those_of_the_command() -> Result<(), Failed> {
    let sandbox = Sandbox::new();
    sandbox.run("schema --out written");
    let (written, folder) = (sandbox.files("written"), workspace().join("docs/reference/schemas"));
    if is_asked_for("overwrite") {
        fs::create_dir_all(&folder)?;
        written.iter().try_for_each(|(name, bytes)| fs::write(folder.join(name), bytes))?;
    }
    let differs = |(name, bytes): &(&PathBuf, &Vec<u8>)| fs::read(folder.join(name)).ok().as_ref() != Some(*bytes);
    let stale: Vec<&PathBuf> = written.iter().filter(differs).map(|(name, _)| name).collect();
    if stale.is_empty() && fs::read_dir(folder)?.count() == written.len() {
        Ok(())
    } else {
        Err(format!("update docs/reference/schemas with mindgap schema: {stale:?} differ").into())
    }
}

fn is_file_of_the_book(path: &Path) -> bool {
    path.is_file() && path.canonicalize().is_ok_and(|path| path.starts_with(workspace().join("docs")))
}

/// Where the links of a document lead, without places within files.
fn links(text: &str) -> Vec<String> {
    let ends = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let files = ends.filter_map(|link| link.split('#').next());
    files.filter(|link| !link.is_empty()).map(str::to_owned).collect()
}
