// Reads each image that it is given the path of, and says on a line what became of it.
#include <iostream>

#include "common/sensor/image.h"

int main(int count, char** arguments) {
  for (int i = 1; i < count; ++i) {
    const auto size = pangaea::ReadImageSize(arguments[i]);
    const auto image = pangaea::ReadGrayImage(arguments[i], size.value_or(pangaea::ImageSize{}));
    std::cout << (image ? "read" : image.error().message) << "\n";
  }
}
