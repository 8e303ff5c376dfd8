//! `mindgap serve`

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};

use mindgap_tests::command::Sandbox;

/// A server that ends with the test.
struct Server(Child);

impl Drop for Server {
    fn drop(&mut self) {
        self.0.kill().and_then(|()| self.0.wait()).expect("a server that can be ended");
    }
}

/// Returns the answer to a request.
fn ask(address: &str, line: &str) -> String {
    let mut stream = TcpStream::connect(address).expect("a server");
    write!(stream, "{line} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").expect("a request");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("an answer");
    answer
}

#[test]
fn page_is_served_to_this_computer_and_nothing_else_is() {
    let sandbox = Sandbox::new();
    sandbox.write("page.html", "<!doctype html><p>Ångström");
    let mut command = sandbox.command("serve --page page.html --port 0");
    let mut server = Server(command.stderr(Stdio::piped()).spawn().expect("the command starts"));
    let mut line = String::new();
    BufReader::new(server.0.stderr.take().expect("a pipe")).read_line(&mut line).expect("a line");
    let address = line.strip_prefix("http://").and_then(|rest| rest.split(' ').next()).expect("an address");
    assert!(address.starts_with("127.0.0.1:"), "{line}");

    let page = ask(address, "GET /");
    assert!(page.starts_with("HTTP/1.1 200") && page.ends_with("<!doctype html><p>Ångström"), "{page}");
    assert!(page.contains("Content-Type: text/html; charset=utf-8\r\n"), "{page}");
    assert!(ask(address, "GET /page.html").starts_with("HTTP/1.1 404"));
    assert!(ask(address, "POST /").starts_with("HTTP/1.1 404"));
    let why =
        sandbox.refused(&format!("serve --page page.html --port {}", address.rsplit(':').next().expect("a port")));
    assert!(why.ends_with("Address already in use (os error 98)"), "{why}");
}

#[test]
fn missing_page_is_one_line() {
    let sandbox = Sandbox::new();
    let why = sandbox.refused("serve");
    assert!(why.contains("make it with host-sim/browser/build.sh"), "{why}");
    assert!(sandbox.refused("serve --page none.html").starts_with("none.html: cannot be read"));
}
