//! The header is what cbindgen makes of the sources; `CONTACTSENSE_WRITE_HEADER=1 cargo test -p contactsense-capi` writes it.

use std::path::Path;

#[test]
fn the_header_is_that_of_the_sources() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).expect("it is in this folder");
    let library = std::fs::read_to_string(folder.join("src/lib.rs")).expect("it is in this folder");
    let modules = library.lines().filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'));
    let builder = modules.fold(cbindgen::Builder::new().with_config(config), |builder, module| {
        builder.with_src(folder.join(format!("src/{module}.rs")))
    });
    let mut made = vec![];
    builder.generate().expect("sources that can be read").write(&mut made);
    let path = folder.join("include/contactsense.h");
    if std::env::var_os("CONTACTSENSE_WRITE_HEADER").is_some() {
        std::fs::write(&path, &made).expect("a folder that can be written to");
    }
    let stored = std::fs::read(&path).unwrap_or_default();
    assert!(stored == made, "{} is not that of the sources", path.display());
}
