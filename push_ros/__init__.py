"""What the nodes share: messages, parameters, quality of service, start and stop."""
