//! Says to the linker of macOS that the names of Python come with the Python that loads the module.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
