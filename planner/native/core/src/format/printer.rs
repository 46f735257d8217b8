//! Text under construction: columns, lines, comments that end a line.

/// Writes words and lists to lines.
#[derive(Default)]
pub(super) struct Printer {
    out: String,
    column: usize,
    /// A comment was written: nothing may follow on this line.
    line_is_over: bool,
}

impl Printer {
    pub fn column(&self) -> usize {
        self.column
    }

    pub fn is_empty(&self) -> bool {
        self.out.is_empty()
    }

    /// Whether the next text must go to a new line.
    pub fn line_is_over(&self) -> bool {
        self.line_is_over
    }

    pub fn text(&mut self, text: &str) {
        self.out.push_str(text);
        self.column += text.chars().count();
    }

    /// A blank, unless the line has just begun.
    pub fn space(&mut self) {
        if !self.out.is_empty() && !self.out.ends_with([' ', '\n', '(', '[']) {
            self.text(" ");
        }
    }

    pub fn comment(&mut self, text: &str) {
        self.text(text);
        self.line_is_over = true;
    }

    pub fn newline(&mut self, indent: usize) {
        while self.out.ends_with(' ') {
            self.out.pop();
        }
        self.out.push('\n');
        self.out.extend(std::iter::repeat_n(' ', indent));
        self.column = indent;
        self.line_is_over = false;
    }

    pub fn blank_line(&mut self) {
        while self.out.ends_with(' ') {
            self.out.pop();
        }
        self.out.push('\n');
    }

    pub fn finish(mut self) -> String {
        while self.out.ends_with([' ', '\n']) {
            self.out.pop();
        }
        if !self.out.is_empty() {
            self.out.push('\n');
        }
        self.out
    }
}
