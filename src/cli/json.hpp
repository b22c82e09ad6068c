// JSON out, numbers with 17 significant digits; what is not finite becomes null.
#pragma once

#include <cmath>
#include <cstdio>
#include <ostream>
#include <string>

#include "model/chain.hpp"

namespace osculate {

class Json {
 public:
  explicit Json(std::ostream& out) : out_(out) {}

  Json& begin_object() { return open('{'); }
  Json& end_object() { return close('}'); }
  Json& begin_array() { return open('['); }
  Json& end_array() { return close(']'); }
  Json& key(const std::string& name) {
    separate();
    quote(name);
    out_ << ": ";
    fresh_ = true;
    return *this;
  }
  Json& null() { return raw("null"); }
  Json& value(int x) { return raw(std::to_string(x)); }
  Json& value(double x) {
    if (!std::isfinite(x)) return null();
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", x);
    return raw(text);
  }
  Json& value(const std::string& text) {
    separate();
    quote(text);
    return *this;
  }
  Json& value(const VectorX<double>& v) {
    begin_array();
    for (const double x : v) value(x);
    return end_array();
  }
  Json& value(const MatrixX<double>& a) {
    begin_array();
    for (Eigen::Index i = 0; i < a.rows(); ++i) value(VectorX<double>(a.row(i)));
    return end_array();
  }

 private:
  void separate() {
    if (!fresh_) out_ << ", ";
    fresh_ = false;
  }
  Json& open(char bracket) {
    separate();
    out_ << bracket;
    fresh_ = true;
    return *this;
  }
  Json& close(char bracket) {
    out_ << bracket;
    fresh_ = false;
    return *this;
  }
  Json& raw(const std::string& text) {
    separate();
    out_ << text;
    return *this;
  }
  void quote(const std::string& text) {
    out_ << '"';
    for (const char c : text) {
      if (c == '"' || c == '\\') {
        out_ << '\\' << c;
      } else if (static_cast<unsigned char>(c) < 0x20) {
        char code[8];
        std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
        out_ << code;
      } else {
        out_ << c;
      }
    }
    out_ << '"';
  }

  std::ostream& out_;
  bool fresh_ = true;  // nothing before on this level
};

}  // namespace osculate
