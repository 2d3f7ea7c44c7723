//! The header is what cbindgen makes of the sources; `CONTACTSENSE_WRITE_HEADER=1 cargo test -p contactsense-capi` writes it.

use std::path::Path;

#[test]
fn the_header_is_that_of_the_sources() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).expect("it is in this folder");
    let mut sources: Vec<_> =
        ["status", "robot", "report", "monitor"].map(|name| folder.join(format!("src/{name}.rs"))).into();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in sources.drain(..) {
        builder = builder.with_src(source);
    }
    let mut made = vec![];
    builder.generate().expect("sources that can be read").write(&mut made);
    let path = folder.join("include/contactsense.h");
    if std::env::var_os("CONTACTSENSE_WRITE_HEADER").is_some() {
        std::fs::write(&path, &made).expect("a folder that can be written to");
    }
    let stored = std::fs::read(&path).unwrap_or_default();
    assert!(stored == made, "{} is not that of the sources", path.display());
}
